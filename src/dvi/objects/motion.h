#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::objects {

/// How a labeled object moves along the poses of the vehicle.
struct TrackMotion {
  int track = 0;
  std::string type;
  std::size_t first = 0, last = 0, frames = 0;  ///< indices of its first and last frame; in how many it has a 3D box
  double way_m = 0;                             ///< between the two of its places that lie apart most surely
  double way_sigma_m = 0;                       ///< by what boxes and poses are wrong
  double speed_mps = 0;                         ///< on that way
  bool moves = false;                           ///< at any time: what waits and then drives off moves
};

/// The motion of each track of `labels` (as the drive's frames) that has 3D boxes, in order of their numbers. Boxes wander, far
/// ones more than near ones: a track moves if two of its places lie apart by more than that.
std::vector<TrackMotion> track_motions(const Drive& drive, const FrameLabels& labels, const Trajectory& world_from_lidar);

/// Tracks that do not move: parked vehicles. What is labeled without box or track may move.
std::set<int> stationary_tracks(const Drive& drive, const Trajectory& world_from_lidar);

/// The drive's labels without those of standing tracks.
FrameLabels without_stationary(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::objects
