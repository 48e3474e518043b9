#pragma once

#include <vector>

#include "dvi/harmonize/filled_frame.h"
#include "dvi/image/color_range.h"
#include "dvi/image/region.h"

namespace dvi::synthesize {

/// Of each pixel of a region, the range of what was known or copied round it: in a window of at least twice its distance to the
/// nearest such pixel, of which such pixels are a quarter. Where there is none, of everything.
std::vector<ColorRange> ranges_round(const harmonize::FilledFrame& frame, const Region& region);

}  // namespace dvi::synthesize
