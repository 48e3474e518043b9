#pragma once

#include <algorithm>

#include <opencv2/core/matx.hpp>

namespace dvi {

/// The gray level from which on the true color may be brighter than the camera's maximum.
inline constexpr float kSaturated = 250;

/// Returns whether any channel is saturated.
inline bool is_saturated(const cv::Vec3f& color) { return std::max({color[0], color[1], color[2]}) >= kSaturated; }

}  // namespace dvi
