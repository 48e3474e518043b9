#pragma once

#include <string>
#include <vector>

#include "dvi/core/run_plan.h"
#include "dvi/job/job.h"

namespace dvi::run {

/// Returns the stages of `dvi run` in order, to estimate the remaining time.
std::vector<PlannedStage> plan_run_stages(const job::Job& job);

/// Returns the stages of `dvi selfcheck` in order: for each scenario, a case, its run, and its evaluation.
std::vector<PlannedStage> plan_selfcheck_stages(const job::Job& job, const std::vector<std::string>& scenarios);

}  // namespace dvi::run
