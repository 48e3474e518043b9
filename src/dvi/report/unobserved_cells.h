#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/report/frame_pictures.h"

namespace dvi::report {

/// A square of the ground that pixels which no other frame saw look at.
struct UnobservedCell {
  std::size_t frame = 0;  ///< the one with most such pixels
  int pixels = 0;         ///< of that frame
};

/// By place, in whole cells of kUnobservedCell meters.
using UnobservedPlaces = std::map<std::pair<int, int>, UnobservedCell>;
inline constexpr double kUnobservedCell = 0.5;

/// Of the pixels of a frame that no source observed (kind 3 to 5), where they lie. `above`: map/above.json, which has camera
/// and poses.
UnobservedPlaces unobserved_places(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above);

void add(const UnobservedPlaces& frame, UnobservedPlaces& sum);

}  // namespace dvi::report
