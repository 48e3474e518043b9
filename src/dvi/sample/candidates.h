#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/region.h"

namespace dvi {

/// Where another frame saw a pixel of the hole.
struct Candidate {
  int view = -1;         ///< source number; -1: nobody saw it
  cv::Point2f position;  ///< in the source's image, quantised to 1/16 px

  bool found() const { return view >= 0; }
};

/// One candidate for each pixel of a frame's hole.
struct Candidates {
  Region hole;
  std::vector<Candidate> of;  ///< as hole.pixels
};

}  // namespace dvi
