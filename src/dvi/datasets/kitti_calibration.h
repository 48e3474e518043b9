#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi::datasets {

/// The calibration of a rectified camera of a day of KITTI raw.
struct KittiCalibration {
  Camera camera;          ///< of the rectified images; size 0 x 0 if the file does not state it
  SE3 camera_from_rect0;  ///< labels are given in the axes of the rectified camera 0
  SE3 rect0_from_lidar;
  Eigen::Matrix3d rect0_rotation = Eigen::Matrix3d::Identity();  ///< from the axes of camera 0 before rectification
  std::vector<fs::path> files;

  SE3 camera_from_lidar() const { return camera_from_rect0 * rect0_from_lidar; }
};

/// Reads calib_cam_to_cam.txt and calib_velo_to_cam.txt of a date folder for a camera "image_02". Throws InputError if a file
/// or an entry is missing or malformed.
KittiCalibration read_kitti_calibration(const fs::path& date_folder, const std::string& camera);

/// Reads calib.txt of a sequence of the odometry benchmark (P0 to P3 and Tr) for a camera "image_2". The file does not state
/// the image size; Tr transforms points from the LiDAR to the rectified camera 0. Throws the same errors.
KittiCalibration read_kitti_odometry_calibration(const fs::path& file, const std::string& camera);

/// Returns whether a camera of KITTI-360 is one of the two fisheye cameras.
bool is_kitti_360_fisheye(const std::string& camera);

/// Reads the pose of a camera relative to the IMU in calib_cam_to_pose.txt of KITTI-360. Throws the same errors.
SE3 read_kitti_360_camera_pose(const fs::path& file, const std::string& camera);

/// Reads perspective.txt and calib_cam_to_velo.txt of KITTI-360 for a perspective camera, "image_00" or "image_01", or also
/// image_02.yaml and calib_cam_to_pose.txt for a fisheye camera, "image_02" or "image_03". Throws the same errors.
KittiCalibration read_kitti_360_calibration(const fs::path& folder, const std::string& camera);

/// Reads calib_imu_to_velo.txt. Throws the same errors.
SE3 read_lidar_from_imu(const fs::path& date_folder);

}  // namespace dvi::datasets
