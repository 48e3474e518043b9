#pragma once

#include <fmt/format.h>

#include "dvi/drive/drive.h"

namespace dvi {

/// Returns a drive of images of camera front, named 000, 001, ..., without files. The frames are numbered from `first_number`.
inline Drive make_image_drive(int images, cv::Size size, int first_number = 0) {
  Drive drive;
  drive.camera.width = size.width, drive.camera.height = size.height;
  drive.camera_name = "front";
  for (int i = 0; i < images; ++i) drive.frames.push_back({first_number + i, fmt::format("{:03}", i), i, {}, {}});
  return drive;
}

}  // namespace dvi
