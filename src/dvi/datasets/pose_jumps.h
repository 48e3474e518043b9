#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// A step between two consecutive poses that is too long for a vehicle.
struct PoseJump {
  std::size_t before = 0, after = 0;  ///< indices of the poses
  double distance_m = 0, seconds = 0;
};

/// Poses that contradict their neighbors.
struct PoseJumps {
  std::vector<bool> outlier;      ///< for each pose: whether it lies apart from most of the others
  std::size_t outliers = 0;       ///< their number
  std::optional<PoseJump> first;  ///< the first jump to or from an outlier
  std::optional<PoseJump> kept;   ///< the first jump between poses of which neither is an outlier
};

/// Finds jumps: steps between consecutive poses that exceed by 5 m what 100 m/s (or ten times the usual speed, if that is more)
/// allows. Poses without a jump between them form a group; groups that are joined by a plausible step are merged. All groups
/// but the largest one are outliers if they are small or far away. Both sides of a shorter, lasting jump are kept, since the
/// correction of a GPS causes it. `poses` are in order of time.
PoseJumps find_pose_jumps(const std::vector<StampedPose>& poses);

/// Removes the outliers from the drive's given poses, and adds warnings about them and about the remaining jumps.
void leave_out_pose_jumps(Drive& drive);

}  // namespace dvi::datasets
