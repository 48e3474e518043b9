#pragma once

#include <vector>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/fuse.h"

namespace dvi::harmonize {

/// A known pixel beside a copied one.
struct RimPixel {
  cv::Point at;
  int view = 0;          ///< the source of the copied one
  cv::Vec3f difference;  ///< its colour, less what this source shows of it
};

/// What the solution of eq. 5 is held near to (screened Poisson: Bhat et al., Fourier analysis of the 2D screened Poisson
/// equation, ECCV 2008).
struct Hold {
  std::vector<cv::Vec3f> colour;  ///< as the hole's pixels: the copies in the light of the rim
  std::vector<float> weight;      ///< the same; 0: not held
};

/// What the sources show for each hole pixel, in the light of the target; zeros where there is no candidate.
struct Copies {
  std::vector<cv::Vec3f> colour;  ///< as fused
  /// Sum over the pixel's neighbours outside the hole of (its colour - the neighbour's), both as its leading source shows them.
  std::vector<cv::Vec3f> outward;
  /// Sum over the pixel's neighbours led by another source of (its colour - the neighbour's), the mean of what both
  /// sources show of the two.
  std::vector<cv::Vec3f> seam;
  std::vector<RimPixel> rim{};  ///< of those that the sources show
  bool of_other_days = false;   ///< some were copied from another drive
  Hold hold{};                  ///< by hold_of()
};

/// Reads one source image at a time.
Copies copy(const Fused& fused, const Views& views, std::size_t target, const depth::DepthMap& depth, const DayLight& light);

}  // namespace dvi::harmonize
