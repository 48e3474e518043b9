#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi::datasets {

/// The calibration of a day of KITTI raw as one of its rectified cameras needs it.
struct KittiCalibration {
  Camera camera;          ///< of the rectified images; size 0 x 0 where the file does not tell it
  SE3 camera_from_rect0;  ///< from the rectified camera 0, in whose axes labels are given
  SE3 rect0_from_lidar;
  Eigen::Matrix3d rect0_rotation = Eigen::Matrix3d::Identity();  ///< from the axes of camera 0 before rectification
  std::vector<fs::path> files;

  SE3 camera_from_lidar() const { return camera_from_rect0 * rect0_from_lidar; }
};

/// Reads calib_cam_to_cam.txt and calib_velo_to_cam.txt of a date folder for a camera "image_02". InputError where a file or
/// an entry is missing or malformed.
KittiCalibration read_kitti_calibration(const fs::path& date_folder, const std::string& camera);

/// Reads calib.txt of a sequence of the odometry benchmark (P0 to P3 and Tr) for a camera "image_2". The size is not in it; Tr
/// takes points from the LiDAR to the rectified camera 0. Errors as above.
KittiCalibration read_kitti_odometry_calibration(const fs::path& file, const std::string& camera);

/// Reads perspective.txt and calib_cam_to_velo.txt of KITTI-360 for a camera "image_00". Errors as above.
KittiCalibration read_kitti_360_calibration(const fs::path& folder, const std::string& camera);

/// Reads calib_imu_to_velo.txt. Errors as above.
SE3 read_lidar_from_imu(const fs::path& date_folder);

}  // namespace dvi::datasets
