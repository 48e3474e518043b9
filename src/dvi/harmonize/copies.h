#pragma once

#include <vector>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/fuse.h"

namespace dvi::harmonize {

/// What the sources show for each hole pixel, in the light of the target; zeros where there is no candidate.
struct Copies {
  std::vector<cv::Vec3f> colour;  ///< as fused
  /// Sum over the pixel's neighbours outside the hole of (its colour - the neighbour's), both as its leading source shows them.
  std::vector<cv::Vec3f> outward;
  /// Sum over the pixel's neighbours led by another source of (its colour - the neighbour's), the mean of what both
  /// sources show of the two.
  std::vector<cv::Vec3f> seam;
  bool of_other_days = false;  ///< some were copied from another drive
};

/// Reads one source image at a time.
Copies copy(const Fused& fused, const Views& views, std::size_t target, const depth::DepthMap& depth, const DayLight& light);

}  // namespace dvi::harmonize
