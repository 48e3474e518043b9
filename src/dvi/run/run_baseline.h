#pragma once

#include "dvi/core/progress.h"
#include "dvi/job/job.h"
#include "dvi/result/run_report.h"
#include "dvi/run/run.h"

namespace dvi::run {

/// run() for the methods that look at images and masks only: no poses, no map. What another method left of these is removed.
result::RunReport run_baseline(const job::Job& job, Progress& progress, const FrameSink& sink);

}  // namespace dvi::run
