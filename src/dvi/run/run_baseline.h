#pragma once

#include "dvi/core/progress.h"
#include "dvi/job/job.h"
#include "dvi/result/run_report.h"
#include "dvi/run/run.h"

namespace dvi::run {

/// Runs a method that uses images and masks only, without poses and map. Removes poses and map of another method from the
/// folder.
result::RunReport run_baseline(const job::Job& job, Progress& progress, const FrameSink& sink);

}  // namespace dvi::run
