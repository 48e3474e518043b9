#pragma once

#include <vector>

#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Tracks with all returns of their objects: in each scan, and for a second before the first and after the last observation,
/// those in the object's box, wherever the track says it is. Other scans tell of parts of an object only: what it covers long
/// enough looks as if it stood.
std::vector<Track> followed(const std::vector<Track>& tracks, const MovingReturns& returns);

}  // namespace dvi::objects
