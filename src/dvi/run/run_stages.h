#pragma once

#include <string>
#include <vector>

#include "dvi/core/run_plan.h"
#include "dvi/job/job.h"

namespace dvi::run {

/// The stages of `dvi run`, in order, for the time that is left.
std::vector<PlannedStage> run_stages(const job::Job& job);

/// Those of `dvi selfcheck` with scenarios of these names: of each a case, its run and its scores.
std::vector<PlannedStage> selfcheck_stages(const job::Job& job, const std::vector<std::string>& scenarios);

}  // namespace dvi::run
