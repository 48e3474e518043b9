#pragma once

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// Reads poses from a text file. The number of entries per line determines the kind:
///   13: NAME of a scan and world_from_lidar (3x4, row-major) at the middle of that scan; other names are ignored.
///       With @SECONDS instead of NAME, the pose at that time.
///    8: seconds tx ty tz qx qy qz qw, world_from_lidar (TUM)
///   12: world_from_camera (3x4, row-major), one line per frame (KITTI, and the poses that dvi writes)
/// If Drive::camera_is_posed, the first two kinds are world_from_camera as well. Commas count as blanks. A first line with
/// column names is skipped; if it names qw before qx, quaternions are read in that order. Throws InputError with file and line
/// if a line is empty, does not hold numbers or a rotation, or contradicts an earlier line of the same scan or time.
Trajectory read_poses(const fs::path& file, const Drive& drive);

}  // namespace dvi::datasets
