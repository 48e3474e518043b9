#pragma once

#include <cstddef>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "dvi/objects/evidence.h"

namespace dvi::objects {

/// Removed tracks of a drive that are stationary.
struct StationaryObjects {
  std::size_t tracks = 0, stationary = 0;  ///< removed tracks; those of them that are stationary
  std::size_t pixels = 0;                  ///< of the hole, that `--remove moving` would not remove
};

// As report.json has it. Only .cpp files that write or read a document use these.
void to_json(nlohmann::json& json, const StationaryObjects& objects);
void from_json(const nlohmann::json& json, StationaryObjects& objects);

/// What is removed although it is stationary; none where the evidence does not show what is stationary.
std::optional<StationaryObjects> count_stationary(const CameraEvidence& evidence, const RemovalOptions& options);

}  // namespace dvi::objects
