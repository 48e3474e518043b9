#pragma once

#include <vector>

#include <opencv2/core/matx.hpp>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {

/// Least and greatest colour, by channel.
struct Range {
  cv::Vec3f low{0, 0, 0}, high{255, 255, 255};

  cv::Vec3f clamped(const cv::Vec3f& colour) const;
};

/// Of each pixel of a region, the range of what was known or copied round it: within twice its distance to the nearest such
/// pixel. Where there is none, of everything.
std::vector<Range> ranges_round(const harmonize::FilledFrame& frame, const Region& region);

}  // namespace dvi::synthesize
