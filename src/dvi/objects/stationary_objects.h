#pragma once

#include <cstddef>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "dvi/objects/evidence.h"

namespace dvi::objects {

/// The removed tracks of a drive that are stationary.
struct StationaryObjects {
  std::size_t tracks = 0;      ///< number of removed tracks
  std::size_t stationary = 0;  ///< number of stationary tracks among them
  std::size_t pixels = 0;      ///< pixels of the hole that `--remove moving` would not remove
};

// The form of report.json. Only .cpp files that write or read a document use these.
void to_json(nlohmann::json& json, const StationaryObjects& objects);

/// Counts the stationary tracks that are removed. Returns nothing if there are none or the evidence does not show the motion
/// state.
std::optional<StationaryObjects> count_stationary(const CameraEvidence& evidence, const RemovalOptions& options);

}  // namespace dvi::objects
