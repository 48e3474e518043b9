#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/region.h"

namespace dvi::sample {

/// Where another frame saw a pixel of the hole.
struct Candidate {
  int view = -1;              ///< source number; -1: no source observed it
  cv::Point2f position;       ///< in the source's image, quantized to 1/16 px
  cv::Vec2b footprint{1, 1};  ///< width and height in source pixels of what the pixel shows: box_mean()
  float trust = 1;            ///< 0..1, see sample/sighting.h
  float misplaced = 0;        ///< px of the target by which the copy is expected to be off

  bool found() const { return view >= 0; }
};

/// The candidates for each pixel of a frame's hole.
struct Candidates {
  Region hole;
  std::vector<Candidate> leading;   ///< as hole.pixels: the one copied from
  std::size_t extra_per_pixel = 0;  ///< how many further ones a pixel may have
  std::vector<Candidate> extra{};   ///< extra_per_pixel each, by falling trust; those not found last

  std::span<const Candidate> others(std::size_t pixel) const {
    return {extra.data() + pixel * extra_per_pixel, extra_per_pixel};
  }
  std::span<Candidate> others(std::size_t pixel) { return {extra.data() + pixel * extra_per_pixel, extra_per_pixel}; }
};

}  // namespace dvi::sample
