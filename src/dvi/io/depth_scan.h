#pragma once

#include "dvi/drive/drive.h"

namespace dvi::io {

/// Makes a scan of a depth image (16-bit PNG, millimetres along the optical axis, 0 unknown): a point a pixel, all at the
/// scan's stamp. InputError where the file is no such image, is of another size or holds no depth.
struct DepthScan {
  Camera camera;
  SE3 lidar_from_camera;

  Scan operator()(const ScanHeader& header) const;
};

}  // namespace dvi::io
