#pragma once

#include <cstddef>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// The change of illumination between other drives and the target, in addition to the gains of the views: the sun is in another
/// direction, so that each side of the street changes differently, and a wet road is darker. It is estimated from surfaces
/// around the hole that both drives show.
struct IlluminationChange {
  struct OfDrive {
    /// One per hole pixel, BGR: the factor from the drive's colors to the illumination of the target; 0 where the surfaces are
    /// not consistent. It is empty if the drive was not compared.
    std::vector<cv::Vec3f> gain;
  };
  std::vector<OfDrive> drives{};  ///< One per drive, by View::drive.
  float max_surface_level = 255;  ///< Largest channel, in gray levels, of the brightest surfaces of the target.

  /// Returns the factor from the colors of a view to the illumination at a pixel of the target's hole.
  cv::Vec3f gain_to(const View& target, const View& source, std::size_t pixel) const {
    const cv::Vec3f gain = dvi::gain_to(target, source);
    const auto drive = static_cast<std::size_t>(source.drive);
    return drive < drives.size() && !drives[drive].gain.empty() ? gain.mul(drives[drive].gain[pixel]) : gain;
  }
  /// Whether surfaces with the orientation of this pixel's have the same colors in both drives, apart from the illumination.
  bool is_consistent(const View& source, std::size_t pixel) const {
    const auto drive = static_cast<std::size_t>(source.drive);
    return drive >= drives.size() || drives[drive].gain.empty() || drives[drive].gain[pixel][0] > 0;
  }
};

/// Compares the unmasked surfaces of the target with the same surfaces in the views of other drives that the hole may be copied
/// from. For each of 26 orientations of surfaces, the weighted median of the logarithm of the color ratio is computed. It is
/// used if the median of each half of the surfaces reduces the differences of the other half. Orientations whose surfaces
/// differ too much even then are inconsistent. Without views of other drives nothing is computed.
IlluminationChange compare_illumination(const depth::Target& target, const sample::Candidates& candidates);

}  // namespace dvi::harmonize
