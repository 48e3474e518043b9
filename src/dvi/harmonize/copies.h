#pragma once

#include <array>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/harmonize/fuse.h"

namespace dvi::harmonize {

/// Parameters of the consistency of copies.
struct SeamParams {
  float inconsistent_levels = 30;       ///< Three times the error of a correct copy, in gray levels.
  float inconsistent_seam_levels = 60;  ///< The same of a seam: two colors in each of two sources are twice as uncertain.
};
inline constexpr SeamParams kSeam;

/// A known pixel next to a copied one.
struct BoundaryPixel {
  cv::Point at;
  int view = 0;          ///< Index of the source of the copied pixel.
  cv::Vec3f difference;  ///< Color of the known pixel minus its color in that source.
};

/// A pair of a hole pixel and its right or lower neighbor that have different sources.
struct Seam {
  cv::Vec3f step;   ///< Color of the pixel minus that of the neighbor: the mean of the sources that show both, or 0.
  int sources = 0;  ///< Number of sources that show both pixels: 0 to 2.
  /// Difference of both sources, in the step and in the mean of the two colors; 0 unless both show the pair.
  float spread = 0;
  cv::Vec3f middle;  ///< Mean of the two colors in the source that was added last.

  /// The weight of the step in eq. 5, by the robust function of Geman and McClure, so that displaced edges and moved shadows do
  /// not change the brightness of the pixels behind them.
  float weight() const;
};

/// The data term of eq. 5 (screened Poisson equation: P. Bhat et al., Fourier analysis of the 2D screened Poisson equation,
/// ECCV 2008).
struct Screening {
  std::vector<cv::Vec3f> color;  ///< One per hole pixel: the copies, in the illumination of the boundary.
  std::vector<float> weight;     ///< One per hole pixel; 0: no data term.
};

/// The colors of the sources for each hole pixel, in the illumination of the target; zeros for pixels without a candidate.
struct Copies {
  std::vector<cv::Vec3f> color;  ///< The colors of Fused.
  /// Sum over the neighbors outside the hole of the pixel's color minus the neighbor's, both in the leading source.
  std::vector<cv::Vec3f> outward;
  std::vector<std::array<Seam, 2>>
      seams;  ///< The seams to the right and lower neighbor; `sources` is 0 if the source is the same.
  std::vector<BoundaryPixel> boundary{};  ///< The known pixels next to copied ones that the sources show.
  bool from_other_drives = false;         ///< Whether pixels were copied from other drives.
  Screening screening{};                  ///< The result of compute_screening().
};

/// Reads the gradients of the copies and the boundary from the sources, one source image at a time.
Copies read_copies(const depth::Target& target, const Fused& fused, const IlluminationChange& illumination);

}  // namespace dvi::harmonize
