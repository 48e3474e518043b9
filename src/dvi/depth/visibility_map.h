#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"
#include "dvi/depth/depth_map.h"

namespace dvi::depth {

/// The visible surfaces of a source frame at half resolution, used for occlusion tests. It takes five bytes per 2 x 2 block of
/// pixels, so that the maps of many source frames can be cached.
struct VisibilityMap {
  static constexpr float kStepsPerMeter = 256;  ///< Unit of `farthest`.
  static constexpr ushort kNoSurface = 0xFFFF;  ///< Sky, unknown, or farther than `farthest` can represent.
  static constexpr float kSpreadSteps = 64;     ///< Unit of `spread`.
  static constexpr float kMaxSigmas = 2;        ///< A depth may be wrong by this many standard deviations.

  /// The depth of the farthest surface within one pixel of the block, so that both surfaces at a depth edge are accepted.
  cv::Mat1w farthest;
  /// The distance from the nearest to the farthest surface there, relative to the nearest; 255: that much or more, or unknown.
  cv::Mat1b spread;
  /// The distance in pixels to the view's own mask, the next depth edge, or the image's border.
  cv::Mat1b clearance;
  /// The view's own mask: one bit per pixel of the block, in raster order.
  cv::Mat1b mask;

  /// Whether any of the pixels that are interpolated at a position of the full image is masked.
  bool is_masked(cv::Point2f at) const {
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    const int x1 = static_cast<int>(std::ceil(at.x)), y1 = static_cast<int>(std::ceil(at.y));
    return is_pixel_masked(x, y) || is_pixel_masked(x1, y) || is_pixel_masked(x, y1) || is_pixel_masked(x1, y1);
  }
  /// Whether the surface at a position occludes depth `z`: it is nearer by more than `tolerance` times its depth.
  bool occludes(cv::Point2f at, double z, double tolerance) const {
    const ushort far = farthest(block_of(at));
    return far != kNoSurface && z > far / kStepsPerMeter * (1 + tolerance);
  }
  /// Whether the surface at a position is surely farther than `z`, by more than `tolerance` times `z`.
  bool is_farther(cv::Point2f at, double z, double tolerance) const {
    const cv::Point b = block_of(at);
    return spread(b) < 255 && z * (1 + tolerance) < farthest(b) / kStepsPerMeter / (1 + spread(b) / kSpreadSteps);
  }
  std::size_t bytes() const { return bytes_of(farthest) + bytes_of(spread) + bytes_of(clearance) + bytes_of(mask); }
  /// The value of `clearance` at a position, in pixels.
  float clearance_px(cv::Point2f at) const { return clearance(block_of(at)); }

 private:
  bool is_pixel_masked(int x, int y) const { return (mask(y / 2, x / 2) >> (y % 2 * 2 + x % 2) & 1) != 0; }
  cv::Point block_of(cv::Point2f at) const {
    return {std::min(static_cast<int>(at.x) / 2, farthest.cols - 1), std::min(static_cast<int>(at.y) / 2, farthest.rows - 1)};
  }
};

/// Computes the visibility map of a view from its depth and its mask (255 = masked).
VisibilityMap make_visibility_map(const DepthMap& depth, const cv::Mat1b& mask);

}  // namespace dvi::depth
