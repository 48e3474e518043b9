#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/holdout/virtual_vehicle.h"
#include "dvi/job/job.h"
#include "dvi/metrics/evaluate.h"

namespace dvi::commands {

/// How well dvi, and other programs, do on a drive of one's own: rows per scenario for people, and all figures for machines.
struct SelfcheckReport {
  std::string json, text;
};

/// For each scenario: `dvi holdout` of job.target into job.out/SCENARIO/case, `dvi run` of it by job's method and options into
/// job.out/SCENARIO/result, and `dvi eval`. Finished cases and runs are not made again. Other programs' frames of a
/// scenario are in FOLDER/SCENARIO. Also writes job.out/selfcheck.json.
SelfcheckReport selfcheck(const job::Job& job, const std::vector<holdout::Scenario>& scenarios,
                          const std::vector<metrics::ExternalFrames>& external, int seed, Progress& progress);

}  // namespace dvi::commands
