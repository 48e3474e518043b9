#pragma once

#include <vector>

#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Sets the height and the size of a track from its own returns.
void estimate_extent(Track& track);

/// Replaces the returns of each track by all returns within the box of its object, per scan, and up to a second before the
/// first and after the last observation. Votes are known for parts of an object only: a position that the object covers for
/// long looks static. Sets the height and the size of each track, and merges tracks of one object.
std::vector<Track> collect_box_returns(std::vector<Track> tracks, const MovingReturns& returns);

}  // namespace dvi::objects
