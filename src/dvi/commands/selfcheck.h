#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/holdout/virtual_vehicle.h"
#include "dvi/job/job.h"
#include "dvi/metrics/evaluate.h"

namespace dvi::commands {

/// The scores of dvi and of other programs on a drive: `text` has a row per scenario, `json` all figures.
struct SelfcheckReport {
  std::string json, text;
};

/// The cases of a selfcheck.
struct SelfcheckOptions {
  std::vector<holdout::Scenario> scenarios;
  std::vector<metrics::ExternalFrames> external;  ///< frames of other programs, in FOLDER/SCENARIO
  int seed = 0;
};

/// Runs `dvi selfcheck`. For each scenario, it makes a holdout case of job.target in job.out/SCENARIO/case, fills it with the
/// job's method and options into job.out/SCENARIO/result, and scores the result. Finished cases and runs are not made again.
/// Also writes job.out/selfcheck.json.
SelfcheckReport selfcheck(const job::Job& job, const SelfcheckOptions& options, Progress& progress);

}  // namespace dvi::commands
