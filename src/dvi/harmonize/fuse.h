#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dvi/depth/target.h"
#include "dvi/harmonize/day_light.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// Gray levels by which colors differ, in the channel where it is most and as a mean over the channels.
float most_different(const cv::Vec3f& a, const cv::Vec3f& b);
float mean_difference(const cv::Vec3f& a, const cv::Vec3f& b);

/// What a source shows of a pixel, in the light of the target.
struct SourceColor {
  cv::Vec3f color;
  float trust = 0;  ///< 0: nothing
};

/// One color of several.
struct Agreement {
  std::size_t leading = 0;   ///< which of them leads
  cv::Vec3f color;           ///< mean of those that agree with it, weighted by trust
  std::uint8_t sources = 0;  ///< how many these are, itself included
  float spread = 0;          ///< mean over all others of how far they are from the leading one, gray levels a channel
};

/// The leading source is the first that at least half of the trust agrees with, so that one that is the odd one out does not
/// lead; two agree if no channel differs by more than noise does.
Agreement agreement(std::span<const SourceColor> shown);

/// The sources of each hole pixel as one.
struct Fused {
  sample::Candidates candidates;      ///< `leading` only, with the footprints that were read; no further ones
  std::vector<cv::Vec3f> color;       ///< as hole.pixels; zeros where there is no candidate
  std::vector<std::uint8_t> sources;  ///< as hole.pixels
  std::vector<float> spread;          ///< as hole.pixels
  cv::Mat1b sky;                      ///< 255: another drive shows what is too bright for the target's light, or bleeds from it
};

/// Reads one source image at a time. Where a box meets the source's mask the pixel itself is taken; saturated colors count
/// only where there are no others. What another drive shows there where it is too bright for the
/// target's light, as its sky is, or mixed with that, is not used.
Fused fuse(const depth::Target& target, const sample::Candidates& candidates, const DayLight& light);

}  // namespace dvi::harmonize
