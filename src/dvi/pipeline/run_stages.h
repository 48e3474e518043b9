#pragma once

#include <string>
#include <vector>

#include "dvi/core/run_plan.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// The stages of `dvi run`, in order, for the time that is left.
std::vector<PlannedStage> run_stages(const Job& job);

/// Those of `dvi selfcheck` with scenarios of these names: of each a case, its run and its scores.
std::vector<PlannedStage> selfcheck_stages(const Job& job, const std::vector<std::string>& scenarios);

}  // namespace dvi::pipeline
