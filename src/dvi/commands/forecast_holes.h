#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/audit/coverage.h"
#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"

namespace dvi::commands {

struct FrameForecastReport {
  int number = 0;
  std::string name;
  double image_share = 0;  ///< of the image that is hole
  audit::HoleShares hole;
};

/// What other frames will have seen of each hole.
struct ForecastReport {
  audit::HoleShares hole;  ///< of all frames
  std::vector<FrameForecastReport> frames;

  std::string table() const;  ///< for people
};
std::string to_json(const ForecastReport& report);
void to_json(nlohmann::json& json, const ForecastReport& report);

/// `dvi forecast`: of job.target (with source drives). Writes forecast.png into job.out unless that is empty. InputError where
/// there are no masks or poses.
ForecastReport forecast_holes(const job::Job& job, Progress& progress);

/// The same for drives whose poses and masks are known.
ForecastReport forecast_holes(const inputs::Inputs& inputs, const job::Job& job, Progress& progress);

}  // namespace dvi::commands
