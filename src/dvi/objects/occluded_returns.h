#pragma once

#include <vector>

#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Adds, to the returns of an object in a scan, those of the scans shortly before and after, moved along the track, if a nearer
/// surface occludes their position in this scan. The camera has another position than the LiDAR and may observe them.
std::vector<Track> add_occluded_returns(std::vector<Track> tracks, const MovingReturns& returns);

}  // namespace dvi::objects
