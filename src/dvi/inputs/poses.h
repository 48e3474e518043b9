#pragma once

#include <optional>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/inputs/choose_poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/registration/registration.h"

namespace dvi::inputs {

/// Where the LiDAR of one drive was.
struct DrivePoses {
  PoseChoice choice;                                          ///< where the poses come from
  Trajectory world_from_lidar;                                ///< world: the target's first LiDAR pose
  std::optional<registration::PlacementFigures> placed = {};  ///< of a source drive that its scans put there
};

/// As the recordings.
using Poses = std::vector<DrivePoses>;

/// Poses of all drives in one world (sections 3.1 and 3.5 of the paper): as the job asks for the target, estimated or given,
/// whichever makes the sharper map, for source drives, which are then laid onto the target by their scans (register_sources.h).
/// InputError where a drive has none, or no frame of the target has one.
Poses estimate_poses(const Recordings& drives, const job::Job& job, Progress& progress);

/// The poses that each drive's choice names, brought into the world of the target's first LiDAR pose; a source drive whose
/// given poses cannot be compared with the target's stays in a world of its own. InputError where there are none.
Poses in_one_world(const Recordings& drives, std::vector<PoseChoice> choices);

/// Whether a drive's given poses say where it lies to the target.
bool shares_world(const Drive& target, const Drive& drive);

/// The given poses, each drive in its own world; empty where none are given.
Poses given_poses(const Recordings& drives);

}  // namespace dvi::inputs
