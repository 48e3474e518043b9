#pragma once

#include <set>

#include "dvi/drive/drive.h"

namespace dvi::masks {

/// Tracks whose 3D boxes keep their place in the world while the drive sees them: parked vehicles. Boxes wander by what labels
/// and poses are wrong, so that a metre is no motion. What is labelled without box or track may move.
std::set<int> standing_tracks(const Drive& drive, const Trajectory& world_from_lidar);

/// The drive's labels without those of standing tracks.
FrameLabels without_standing(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::masks
