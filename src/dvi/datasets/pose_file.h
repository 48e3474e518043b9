#pragma once

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// Poses from a text file, by the number of entries a line:
///   13: NAME of a scan and world_from_lidar (3x4, row-major) at the middle of its scan; names of no scan are left out.
///       Or @SECONDS instead of NAME: the pose at that time
///    8: seconds tx ty tz qx qy qz qw, world_from_lidar (TUM)
///   12: world_from_camera (3x4, row-major), one line a frame (KITTI, and what dvi writes)
/// Where Drive::camera_is_posed, the first two kinds are world_from_camera too.
/// Commas count as blanks, and a first line that names columns is left out; where it names qw before qx, quaternions are read
/// in that order. InputError naming file and line where a line is empty, is not numbers, holds no rotation, or contradicts an
/// earlier line of the same scan or time.
Trajectory read_poses(const fs::path& file, const Drive& drive);

}  // namespace dvi::datasets
