#pragma once

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"
#include "dvi/pipeline/report.h"
#include "dvi/pipeline/run.h"

namespace dvi::pipeline {

/// run() for the methods that look at images and masks only: no poses, no map. What another method left of these is removed.
RunReport run_baseline(const Job& job, Progress& progress, const FrameSink& sink);

}  // namespace dvi::pipeline
