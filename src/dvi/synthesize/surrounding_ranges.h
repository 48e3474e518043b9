#pragma once

#include <vector>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/color_range.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {

/// Computes, for each pixel of a region, the color range of known and copied pixels around it, in a square window. The half
/// width of the window is at least twice the distance to the nearest such pixel, and at least a quarter of its pixels are known
/// or copied. In the largest window, 513 px wide, one such pixel suffices. Without
/// any, the range has all colors.
std::vector<ColorRange> find_surrounding_ranges(const harmonize::FilledFrame& frame, const Region& region);

}  // namespace dvi::synthesize
