#pragma once

#include <algorithm>

#include <opencv2/core/matx.hpp>

namespace dvi {

/// Grey levels from which on the true colour may be brighter than the camera could show it.
inline constexpr float kSaturated = 250;

/// Whether this holds for any channel.
inline bool is_saturated(const cv::Vec3f& colour) { return std::max({colour[0], colour[1], colour[2]}) >= kSaturated; }

}  // namespace dvi
