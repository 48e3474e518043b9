#pragma once

#include <vector>

#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Adds to each scan's returns of an object those of the scans before and after it, moved along the track, where this scan has
/// something nearer in the way: the camera, which looks from elsewhere, may see past it.
std::vector<Track> completed(const std::vector<Track>& tracks, const MovingReturns& returns);

}  // namespace dvi::objects
