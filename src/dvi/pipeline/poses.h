#pragma once

#include <vector>

#include "dvi/core/progress.h"
#include "dvi/pipeline/choose_poses.h"
#include "dvi/pipeline/recordings.h"

namespace dvi::pipeline {

/// Where the LiDAR of one drive was.
struct DrivePoses {
  PoseChoice choice;            ///< where the poses come from
  Trajectory world_from_lidar;  ///< world: the target's first LiDAR pose
};

/// As the recordings.
using Poses = std::vector<DrivePoses>;

/// Poses of all drives in one world (section 3.1 of the paper): as the job asks for the target, estimated or given, whichever
/// makes the sharper map, for source drives. InputError where a drive has none, or no frame of the target has one.
Poses estimate_poses(const Recordings& drives, const Job& job, Progress& progress);

/// The poses that each drive's choice names, brought into the world of the target's first LiDAR pose. InputError where there
/// are none.
Poses in_one_world(const Recordings& drives, std::vector<PoseChoice> choices);

/// The given poses, each drive in its own world; empty where none are given.
Poses given_poses(const Recordings& drives);

}  // namespace dvi::pipeline
