#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/region.h"

namespace dvi::sample {

/// A position in a source frame where a pixel of the hole is observed.
struct Candidate {
  int view = -1;                ///< Index of the source frame; -1: no source observed the pixel.
  cv::Point2f position;         ///< Image coordinates in the source, rounded to 1/16 px.
  cv::Vec2b footprint{1, 1};    ///< Width and height, in source pixels, of the area that the pixel covers, for box_mean().
  float score = 1;              ///< 0..1, by score_source().
  float position_error_px = 0;  ///< Expected displacement of the copy, in pixels of the target.

  bool found() const { return view >= 0; }
};

/// The candidates for each pixel of a frame's hole.
struct Candidates {
  Region hole;
  std::vector<Candidate> leading;   ///< One per hole pixel: the candidate that is copied.
  std::size_t extra_per_pixel = 0;  ///< Maximum number of further candidates per pixel.
  std::vector<Candidate> extra{};   ///< `extra_per_pixel` per hole pixel, by decreasing score; those not found are last.

  /// The further candidates of a hole pixel.
  std::span<const Candidate> others(std::size_t pixel) const {
    return {extra.data() + pixel * extra_per_pixel, extra_per_pixel};
  }
  std::span<Candidate> others(std::size_t pixel) { return {extra.data() + pixel * extra_per_pixel, extra_per_pixel}; }
};

}  // namespace dvi::sample
