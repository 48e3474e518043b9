#pragma once

#include <algorithm>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/depth_map.h"

namespace dvi {

/// What a view can lend to others, small enough to keep for many views: a value for each 2 x 2 block of pixels.
struct VisibilityMap {
  static constexpr float kScale = 256;
  static constexpr ushort kMasked = 0;     ///< within the margin of the view's own mask: lends nothing
  static constexpr ushort kOpen = 0xFFFF;  ///< sky, unknown or farther than the scale holds: hides nothing

  /// Metres x 256 of the farthest surface within a pixel of the block, so that at a depth edge either surface counts.
  cv::Mat1w farthest;

  /// Whether the colour at a position of the full image is masked.
  bool masked(cv::Point2f at) const { return value(at) == kMasked; }
  /// Whether what is seen there is nearer than `z` by more than the part `tolerance` of its depth.
  bool hides(cv::Point2f at, double z, double tolerance) const {
    return value(at) != kOpen && z > value(at) / kScale * (1 + tolerance);
  }

 private:
  ushort value(cv::Point2f at) const {
    return farthest(std::min(static_cast<int>(at.y) / 2, farthest.rows - 1),
                    std::min(static_cast<int>(at.x) / 2, farthest.cols - 1));
  }
};

VisibilityMap visibility_map(const DepthMap& depth, const cv::Mat1b& mask, int mask_margin_px);

}  // namespace dvi
