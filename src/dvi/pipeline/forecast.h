#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"
#include "dvi/pipeline/open.h"

namespace dvi::pipeline {

/// What other frames will have seen of each hole, for machines and as a table for people.
struct ForecastReport {
  std::string json, text;
};

/// `dvi forecast`: of job.target (with further drives), by the poses as they are given. Writes forecast.png into job.out
/// unless that is empty. InputError where there are no masks or poses.
ForecastReport forecast_holes(const Job& job, Progress& progress);

/// The forecast of drives that are open, as JSON; `views` are theirs.
nlohmann::json forecast_json(const std::vector<OpenDrive>& drives, const Job& job, Progress& progress);

}  // namespace dvi::pipeline
