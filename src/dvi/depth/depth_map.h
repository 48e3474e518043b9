#pragma once

#include <cstddef>
#include <limits>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"

namespace dvi::depth {

/// The depth of every pixel of a view.
struct DepthMap {
  static constexpr float kUnknown = 0;                                   ///< The map has no return near the pixel.
  static constexpr float kSky = std::numeric_limits<float>::infinity();  ///< The pixel is above the topmost return.
  /// The depth, in meters, of pixels for which several views show no parallax: the sky, or a surface as distant.
  static constexpr float kInfinity = 1e7F;

  cv::Mat1f z;      ///< Camera::depth() in meters, or kUnknown, or kSky.
  cv::Mat1f sigma;  ///< The standard deviation of `z` in meters; 0 where `z` is unknown or sky.

  std::size_t bytes() const { return bytes_of(z) + bytes_of(sigma); }
  /// Whether the depth is neither unknown nor sky; it may be kInfinity.
  static bool is_surface(float depth) { return depth > 0 && depth < kSky; }
  /// Whether the depth is that of a surface nearer than kInfinity.
  static bool is_solid(float depth) { return depth > 0 && depth < kInfinity; }
};

}  // namespace dvi::depth
