#pragma once

#include <algorithm>

#include <opencv2/core/matx.hpp>

namespace dvi {

/// BGR, 0 to 255, each channel by itself.
struct ColourRange {
  cv::Vec3f low = cv::Vec3f::all(0), high = cv::Vec3f::all(255);

  cv::Vec3f clamped(const cv::Vec3f& colour) const {
    cv::Vec3f out;
    for (int c = 0; c < 3; ++c) out[c] = std::clamp(colour[c], low[c], high[c]);
    return out;
  }
};

}  // namespace dvi
