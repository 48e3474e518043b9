#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dvi/report/frame_pictures.h"

namespace dvi::report {

/// A square of the ground that pixels which no other frame saw look at.
struct UnseenCell {
  std::size_t frame = 0;  ///< the one with most such pixels
  int pixels = 0;         ///< of that frame
};

/// By place, in whole cells of kUnseenCell meters.
using UnseenPlaces = std::map<std::pair<int, int>, UnseenCell>;
inline constexpr double kUnseenCell = 0.5;

/// Of the pixels of a frame that nobody saw (kind 3 to 5), where they lie. `above`: map/above.json, which has camera and poses.
UnseenPlaces unseen_places(const FramePictures& pictures, std::size_t frame, const nlohmann::json& above);

void add(const UnseenPlaces& frame, UnseenPlaces& sum);

}  // namespace dvi::report
