#pragma once

#include <optional>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/inputs/choose_poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/registration/registration.h"

namespace dvi::inputs {

/// The poses of the LiDAR of one drive.
struct DrivePoses {
  PoseChoice choice;                                          ///< the source of the poses, and its diagnostics
  Trajectory world_from_lidar;                                ///< world: the target's first LiDAR pose
  std::optional<registration::PlacementFigures> placed = {};  ///< of a source drive registered by its scans
};

/// One entry per recording, in the same order.
using Poses = std::vector<DrivePoses>;

/// Estimates the poses of all drives in one world (sections 3.1 and 3.5 of the paper). The job's `poses` applies to the target.
/// Source drives use estimated or given poses, whichever make the sharper map, and are then registered to the target by their
/// scans (register_sources.h). Throws InputError if a drive has no poses, or if no frame of the target has one.
Poses estimate_poses(const Recordings& drives, const job::Job& job, Progress& progress);

/// Transforms the chosen poses of each drive to the world of the target's first LiDAR pose. A source drive that has no given
/// poses in the target's world stays in a world of its own. Throws InputError if a drive has no poses.
Poses transform_to_target_world(const Recordings& drives, std::vector<PoseChoice> choices);

/// Whether both drives have given poses, which then are in one world.
bool shares_world(const Drive& target, const Drive& drive);

/// Returns the given poses, each drive in its own world; empty for a drive without given poses.
Poses use_given_poses(const Recordings& drives);

}  // namespace dvi::inputs
