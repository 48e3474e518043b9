#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"
#include "dvi/depth/depth_map.h"

namespace dvi::depth {

/// What a source frame shows and hides, small enough to cache for many: five bytes per 2 x 2 block of pixels.
struct VisibilityMap {
  static constexpr float kScale = 256;
  static constexpr ushort kOpen = 0xFFFF;    ///< sky, unknown or farther than the scale holds: hides nothing
  static constexpr float kSpreadScale = 64;  ///< of `spread`
  static constexpr float kSigmas = 2;        ///< by so many of its standard deviations a surface may be off

  /// Meters x 256 of the farthest surface within a pixel of the block, so that at a depth edge either surface counts.
  cv::Mat1w farthest;
  /// By what part of the nearest surface there the farthest lies behind it, x 64; 255: so much or more, or not known.
  cv::Mat1b spread;
  /// Pixels to the view's own mask, to the next depth edge or to the image's border.
  cv::Mat1b clear;
  /// A bit for each pixel of the block, row by row: the view's own mask.
  cv::Mat1b mask;

  /// Whether a pixel that makes up the color at a position of the full image is masked.
  bool masked(cv::Point2f at) const {
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
    const int x1 = static_cast<int>(std::ceil(at.x)), y1 = static_cast<int>(std::ceil(at.y));
    return masked_pixel(x, y) || masked_pixel(x1, y) || masked_pixel(x, y1) || masked_pixel(x1, y1);
  }
  /// Whether what is seen there is nearer than `z` by more than the part `tolerance` of its depth.
  bool hides(cv::Point2f at, double z, double tolerance) const {
    const ushort far = farthest(block(at));
    return far != kOpen && z > far / kScale * (1 + tolerance);
  }
  /// Whether what is seen there is surely farther than `z` by more than the part `tolerance`.
  bool sees_through(cv::Point2f at, double z, double tolerance) const {
    const cv::Point b = block(at);
    return spread(b) < 255 && z * (1 + tolerance) < farthest(b) / kScale / (1 + spread(b) / kSpreadScale);
  }
  std::size_t bytes() const { return bytes_of(farthest) + bytes_of(spread) + bytes_of(clear) + bytes_of(mask); }
  float clear_px(cv::Point2f at) const { return clear(block(at)); }

 private:
  bool masked_pixel(int x, int y) const { return (mask(y / 2, x / 2) >> (y % 2 * 2 + x % 2) & 1) != 0; }
  cv::Point block(cv::Point2f at) const {
    return {std::min(static_cast<int>(at.x) / 2, farthest.cols - 1), std::min(static_cast<int>(at.y) / 2, farthest.rows - 1)};
  }
};

VisibilityMap visibility_map(const DepthMap& depth, const cv::Mat1b& mask);

}  // namespace dvi::depth
