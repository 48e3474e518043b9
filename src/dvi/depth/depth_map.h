#pragma once

#include <cstddef>
#include <limits>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"

namespace dvi::depth {

/// Depth of every pixel of a view.
struct DepthMap {
  static constexpr float kUnknown = 0;
  static constexpr float kSky = std::numeric_limits<float>::infinity();
  static constexpr float kInfinity = 1e7F;  ///< meters; where views agree on what does not move between them: sky, or as far

  cv::Mat1f z;      ///< meters along the optical axis; kUnknown, or kSky above the last return
  cv::Mat1f sigma;  ///< its standard deviation in meters; 0 where z is unknown or sky

  std::size_t bytes() const { return bytes_of(z) + bytes_of(sigma); }
  static bool is_surface(float depth) { return depth > 0 && depth < kSky; }
  /// Neither unknown nor sky.
  static bool is_solid(float depth) { return depth > 0 && depth < kInfinity; }
};

}  // namespace dvi::depth
