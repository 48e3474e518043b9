#pragma once

#include <string>

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// run() for the methods that look at images and masks only: no poses, no map. What another method left of these is removed.
std::string run_baseline(const Job& job, Progress& progress);

}  // namespace dvi::pipeline
