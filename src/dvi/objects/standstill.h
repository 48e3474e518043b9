#pragma once

#include <vector>

#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Extends tracks to the scans in which their objects stand still before they leave or after they arrive. Such returns lie
/// where scans observed free space for a clear period after the object had left, or before it arrived, however long it stood.
/// Only objects that were found to move are extended, so that parked vehicles stay.
std::vector<Track> extend_through_standstill(std::vector<Track> tracks, const MovingReturns& returns);

}  // namespace dvi::objects
