#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/audit/coverage.h"
#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"

namespace dvi::commands {

/// The coverage of the hole of one frame.
struct FrameCoverageReport {
  int number = 0;
  std::string name;
  double image_share = 0;  ///< share of the image that is hole
  audit::HoleShares hole;
};

/// The share of each hole that sources observe.
struct CoverageReport {
  audit::HoleShares hole;  ///< of all frames
  std::vector<FrameCoverageReport> frames;

  std::string table() const;  ///< as text
};
std::string to_json(const CoverageReport& report);
void to_json(nlohmann::json& json, const CoverageReport& report);

/// Runs `dvi forecast`: estimates the coverage of the holes of job.target by its own frames, cameras, and source drives. Writes
/// a chart, forecast.png, to job.out unless that is empty. Throws InputError if there are no masks or poses.
CoverageReport estimate_coverage(const job::Job& job, Progress& progress);

/// Estimates the coverage for drives whose poses and masks are known.
CoverageReport estimate_coverage(const inputs::Inputs& inputs, const job::Job& job, Progress& progress);

}  // namespace dvi::commands
