#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/harmonize/illumination_change.h"
#include "dvi/image/color_difference.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// The color of a pixel in a source, in the illumination of the target.
struct SourceColor {
  cv::Vec3f color;
  float weight = 0;  ///< The score of the candidate, reduced for saturated colors; 0: not used.
};

/// The consensus of several colors.
struct Agreement {
  std::size_t leading = 0;   ///< Index of the leading color.
  cv::Vec3f color;           ///< Weighted mean of the colors that agree with it.
  std::uint8_t sources = 0;  ///< Number of these colors, including the leading one.
  float spread = 0;          ///< Mean difference of all other colors to the leading one, in gray levels per channel.
};

/// Combines colors, of which at least one has a weight. The leading color is the first with which at least half of the weight
/// agrees, so that an outlier does not lead; if there is none, that with the largest weight. Two colors agree if no channel
/// differs by more than noise.
Agreement find_agreement(std::span<const SourceColor> colors);

/// The fused sources of each hole pixel.
struct Fused {
  sample::Candidates candidates;      ///< Only `leading`, with the footprints that were read.
  std::vector<cv::Vec3f> color;       ///< One per hole pixel; zeros if it has no candidate.
  std::vector<std::uint8_t> sources;  ///< One per hole pixel, as Agreement::sources.
  std::vector<float> spread;          ///< One per hole pixel, as Agreement::spread.
  cv::Mat1b sky;  ///< 255: a source of another drive is too bright there for a surface, or adjacent to such.
};

/// Reads the candidates' colors, one source image at a time, and fuses those of each pixel. Footprints that overlap the mask of
/// the source are reduced to one pixel. Saturated colors have a low weight. Colors of other drives that are brighter than any
/// surface of the target, as sky, or adjacent to such, are not used.
Fused fuse(const depth::Target& target, const sample::Candidates& candidates, const IlluminationChange& illumination);

}  // namespace dvi::harmonize
