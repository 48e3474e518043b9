#pragma once

#include <algorithm>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/depth_map.h"

namespace dvi {

/// What a source's depth map must tell about occlusion, in a sixteenth of its memory: at half the resolution the farthest
/// surface within a pixel of each 2 x 2 block, in metres x 256. At a depth edge a pixel so counts for either side.
struct OcclusionMap {
  static constexpr float kScale = 256;
  static constexpr ushort kNone = 0xFFFF;  ///< sky, unknown or farther than the scale holds: hides nothing

  cv::Mat1w farthest;

  /// Whether what is seen round a pixel of the full image is nearer than `z` by more than the part `tolerance`.
  bool hides(cv::Point2f at, double z, double tolerance) const {
    const int x = std::min(static_cast<int>(at.x) / 2, farthest.cols - 1);
    const int y = std::min(static_cast<int>(at.y) / 2, farthest.rows - 1);
    const ushort seen = farthest(y, x);
    return seen != kNone && z > seen / kScale * (1 + tolerance);
  }
};

OcclusionMap occlusion_map(const DepthMap& depth);

}  // namespace dvi
