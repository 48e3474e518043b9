#include "dvi/io/depth_scan.h"

#include "dvi/core/error.h"
#include "dvi/io/write_image.h"

namespace dvi::io {

Scan DepthScan::operator()(const ScanHeader& header) const {
  constexpr double kMillimetre = 1e-3;
  const cv::Mat1w depth = read_png_depth(header.file, {camera.width, camera.height});
  Scan scan;
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      if (depth(y, x) > 0)
        scan.points.emplace_back((lidar_from_camera * (kMillimetre * depth(y, x) * camera.ray({x, y}))).cast<float>());
  if (scan.points.empty()) throw InputError(header.file, "holds no depth", "remove the file; dvi bridges a missing one");
  scan.intensity.assign(scan.size(), 0.0F);
  scan.time.assign(scan.size(), 0.0F);
  return scan;
}

}  // namespace dvi::io
