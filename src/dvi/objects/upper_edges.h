#pragma once

#include <span>

#include "dvi/objects/evidence.h"
#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// Finds the upper edges of tracked objects that reach above the highest rays of the scans, such as trucks and buses close
/// ahead, and sets Track::height_m and Track::reaches_above_scans of these. The upper edge is searched in the images of the
/// camera. Method: docs/algorithms/motion_segmentation.md.
void find_upper_edges(const CameraEvidence& camera, const MovingReturns& returns, std::span<Track> tracks);

}  // namespace dvi::objects
