#pragma once

#include <algorithm>

#include <opencv2/core/matx.hpp>

namespace dvi {

/// Gray levels from which on the true color may be brighter than the camera could show it.
inline constexpr float kSaturated = 250;

/// Whether this holds for any channel.
inline bool is_saturated(const cv::Vec3f& color) { return std::max({color[0], color[1], color[2]}) >= kSaturated; }

}  // namespace dvi
