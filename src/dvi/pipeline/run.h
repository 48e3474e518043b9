#pragma once

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"
#include "dvi/pipeline/report.h"

namespace dvi::pipeline {

/// The main job: the target drive without what its masks cover, into job.out (layout: docs/concepts.md). Goes on from where an
/// interrupted run stopped. InputError, with nothing half-written, where the data or the folder are not usable.
RunReport run(const Job& job, Progress& progress);

}  // namespace dvi::pipeline
