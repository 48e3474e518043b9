#pragma once

#include <cstddef>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// How the light on the target's day differs from that of other drives, beside the gains of their views: another sun lights
/// each side of the street anew, and a wet road is darker. Found from the surfaces round the hole that both days show.
struct DayLight {
  struct OfDrive {
    /// As hole.pixels, BGR: the drive's colors there times this are in the target's light; 0 where the days do not agree;
    /// empty where nothing is known.
    std::vector<cv::Vec3f> gain;
  };
  std::vector<OfDrive> drives{};  ///< by View::drive
  float brightest = 255;          ///< of the surfaces round the hole, gray levels of the channel where they are brightest

  /// What brings the colors of one view into the light of a pixel of the target's hole.
  cv::Vec3f gain_to(const View& target, const View& source, std::size_t pixel) const {
    const cv::Vec3f gain = dvi::gain_to(target, source);
    const auto drive = static_cast<std::size_t>(source.drive);
    return drive < drives.size() && !drives[drive].gain.empty() ? gain.mul(drives[drive].gain[pixel]) : gain;
  }
  /// Whether surfaces that face as this pixel's does look the same on both days, beside the light.
  bool agrees(const View& source, std::size_t pixel) const {
    const auto drive = static_cast<std::size_t>(source.drive);
    return drive >= drives.size() || drives[drive].gain.empty() || drives[drive].gain[pixel][0] > 0;
  }
};

/// Compares the unmasked surfaces of the target with what those views of other drives show of them that the hole may be copied
/// from. The logarithm of the ratio of both colors, by the direction that a surface faces, has a weighted median in each of
/// 26 directions; a direction counts if what one half of the surfaces says makes the other half agree better, and the other way
/// round. Surfaces that differ too much even so do not agree. Without views of other drives it costs nothing.
DayLight compare_days(const depth::Target& target, const sample::Candidates& candidates);

}  // namespace dvi::harmonize
