#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::objects {

/// The motion of a labeled object in world axes.
struct TrackMotion {
  int track = 0;
  std::string type;
  std::size_t first = 0, last = 0;  ///< indices of its first and last frame with a 3D box
  std::size_t frames = 0;           ///< number of frames with a 3D box
  double displacement_m = 0;        ///< between the two positions whose displacement is most significant
  double displacement_sigma_m = 0;  ///< standard deviation of the displacement, from errors of boxes and poses
  double speed_mps = 0;             ///< mean speed between these positions
  bool moves = false;               ///< whether it moves at any time: an object that waits and then drives off moves
};

/// Measures the motion of each track of `labels` (per frame of the drive) that has 3D boxes, in order of track numbers. Boxes
/// have errors, which grow with the distance. A track moves if two of its positions differ by more than these explain.
std::vector<TrackMotion> measure_track_motions(const Drive& drive, const FrameLabels& labels,
                                               const Trajectory& world_from_lidar);

/// Returns the labeled tracks that do not move, such as parked vehicles. Labels without a box or a track count as moving.
std::set<int> find_stationary_tracks(const Drive& drive, const Trajectory& world_from_lidar);

/// Returns the labels of the drive without those of stationary tracks.
FrameLabels remove_stationary(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::objects
