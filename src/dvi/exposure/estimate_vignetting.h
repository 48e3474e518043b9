#pragma once

#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/drive/view.h"
#include "dvi/exposure/sightings.h"

namespace dvi::exposure {

/// View::vignetting of each view, one for all of a sequence: from points that views of it show at different distances from the
/// center of the image, robustly. 0 where it does not show: less than a percent at half a radian, or if what half of the pairs
/// say does not hold for the other half.
std::vector<float> estimate_vignetting(const Views& views, const Lazy<Sightings>& seen);

}  // namespace dvi::exposure
