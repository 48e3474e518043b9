#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// A step between two consecutive poses that no vehicle drives.
struct PoseJump {
  std::size_t before = 0, after = 0;  ///< indices of the poses
  double distance_m = 0, seconds = 0;
};

/// Poses that contradict their neighbors.
struct PoseJumps {
  std::vector<bool> outlier;      ///< as the poses: lies apart from most of the others
  std::size_t outliers = 0;       ///< how many
  std::optional<PoseJump> first;  ///< the first jump to or from an outlier
  std::optional<PoseJump> kept;   ///< the first jump between poses of which neither is an outlier
};

/// Finds jumps: steps between consecutive poses that are 5 m longer than 100 m/s (or ten times the usual speed, if that is
/// more) allow. Poses without a jump between them are a group; groups that a plausible step joins are one. All groups but the
/// largest are outliers if they are small or lie far away. Both sides of a shorter, lasting jump are kept, as a correction of a
/// GPS causes it. `poses` are in order of time.
PoseJumps find_pose_jumps(const std::vector<StampedPose>& poses);

/// Leaves outliers out of the drive's given poses, and warns of them and of jumps that remain.
void leave_out_pose_jumps(Drive& drive);

}  // namespace dvi::datasets
