#include "dvi/datasets/kitti_calibration.h"
#include "parser.h"

// Both files in one: their keys differ.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  for (const char* name : {"calib_cam_to_cam.txt", "calib_velo_to_cam.txt", "calib_imu_to_velo.txt"}) put(folder / name, bytes);
  datasets::read_lidar_from_imu(folder);
  datasets::read_kitti_calibration(folder, "image_02").camera_from_lidar();
}
