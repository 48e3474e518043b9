#pragma once

#include <array>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/harmonize/fuse.h"

namespace dvi::harmonize {

/// Gray levels: three times what a right copy may be off by. A seam is between two colors in each of two sources, which is
/// twice as uncertain.
constexpr float kDoubtful = 30, kDoubtfulSeam = 2 * kDoubtful;

/// A known pixel beside a copied one.
struct RimPixel {
  cv::Point at;
  int view = 0;          ///< the source of the copied one
  cv::Vec3f difference;  ///< its color, less what this source shows of it
};

/// A hole pixel and its neighbor to the right, or below, which another source shows.
struct Seam {
  cv::Vec3f step;    ///< its color less the neighbor's: the mean of what both sources show of the two, 0 where one does not
  int shown = 0;     ///< how many of both do
  float doubt = 0;   ///< gray levels by which they differ in the step and in the mean of the two colors; 0 unless both show it
  cv::Vec3f middle;  ///< that mean, as shown last

  /// In eq. 5, that of Geman and McClure: misplaced edges and moved shadows must not set how bright all beyond them is.
  float weight() const;
};

/// What the solution of eq. 5 is held near to (screened Poisson: Bhat et al., Fourier analysis of the 2D screened Poisson
/// equation, ECCV 2008).
struct Hold {
  std::vector<cv::Vec3f> color;  ///< as the hole's pixels: the copies in the light of the rim
  std::vector<float> weight;     ///< the same; 0: not held
};

/// What the sources show for each hole pixel, in the light of the target; zeros where there is no candidate.
struct Copies {
  std::vector<cv::Vec3f> color;  ///< as fused
  /// Sum over the pixel's neighbors outside the hole of (its color - the neighbor's), both as its leading source shows them.
  std::vector<cv::Vec3f> outward;
  std::vector<std::array<Seam, 2>> seams;  ///< to the right and below; elsewhere none is shown
  std::vector<RimPixel> rim{};             ///< of those that the sources show
  bool of_other_days = false;              ///< some were copied from another drive
  Hold hold{};                             ///< by hold_of()
};

/// Reads one source image at a time.
Copies copy(const depth::Target& target, const Fused& fused, const DayLight& light);

}  // namespace dvi::harmonize
