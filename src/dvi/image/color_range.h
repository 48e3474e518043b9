#pragma once

#include <algorithm>

#include <opencv2/core/matx.hpp>

namespace dvi {

/// A range of BGR colors, 0 to 255, separate for each channel.
struct ColorRange {
  cv::Vec3f low = cv::Vec3f::all(0), high = cv::Vec3f::all(255);

  cv::Vec3f clamp(const cv::Vec3f& color) const {
    cv::Vec3f out;
    for (int c = 0; c < 3; ++c) out[c] = std::clamp(color[c], low[c], high[c]);
    return out;
  }
  /// Returns the range extended to a color.
  ColorRange with(const cv::Vec3f& color) const {
    ColorRange out = *this;
    for (int c = 0; c < 3; ++c) {
      out.low[c] = std::min(low[c], color[c]);
      out.high[c] = std::max(high[c], color[c]);
    }
    return out;
  }
  bool contains(const ColorRange& other) const {
    bool all = true;
    for (int c = 0; c < 3; ++c) all &= low[c] <= other.low[c] && other.high[c] <= high[c];
    return all;
  }
};

}  // namespace dvi
