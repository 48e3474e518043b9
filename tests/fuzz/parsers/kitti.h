#pragma once

#include "dvi/datasets/reader.h"
#include "parser.h"

namespace dvi::fuzz {

/// Reads a KITTI drive of two frames, of which the caller says the packets of oxts and the lines of all files of timestamps.
inline void parse_kitti(const fs::path& day, const std::string& packet, const std::string& stamps) {
  const fs::path drive = day / "2011_09_26_drive_0001_sync";
  put_two_frames(drive / "image_02/data", drive / "velodyne_points/data");
  put(day / "calib_cam_to_cam.txt", "R_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_02: 8 0 4 0 0 8 3 0 0 0 1 0\n");
  for (const char* name : {"calib_velo_to_cam.txt", "calib_imu_to_velo.txt"})
    put(day / name, "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0\n");
  for (const char* name : {"1.txt", "2.txt"}) put(drive / "oxts/data" / name, packet);
  for (const char* sensor : {"image_02", "velodyne_points", "oxts"}) put(drive / sensor / "timestamps.txt", stamps);
  datasets::read_drive(drive);
}

}  // namespace dvi::fuzz
