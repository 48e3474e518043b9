#pragma once

#include <string>

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// The main job: the target drive without what its masks cover, into job.out (layout: docs/concepts.md). Takes up an
/// interrupted run where it stopped. Returns report.json. InputError, with nothing half-written, where the data do not do.
std::string run(const Job& job, Progress& progress);

}  // namespace dvi::pipeline
