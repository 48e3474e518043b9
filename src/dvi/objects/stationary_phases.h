#pragma once

#include <vector>

#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Extends tracks to the scans in which their objects are stationary, before they leave or after they arrive. The returns of a
/// stationary object lie where scans observed free space for a clear period after the object left, or before it arrived. The
/// length of the stationary phase does not matter. Only moving objects are extended, so that parked vehicles remain.
std::vector<Track> extend_through_stationary_phases(std::vector<Track> tracks, const MovingReturns& returns);

}  // namespace dvi::objects
