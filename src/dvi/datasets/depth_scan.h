#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The camera that took depth images, and what their values mean: 16-bit PNG, depth along the optical axis; 0 and 65535 are no
/// depth.
struct DepthCamera {
  std::optional<Camera> camera = {};         ///< none: its pixels are those of the color images
  std::optional<SE3> depth_from_color = {};  ///< none: registered, it measures from the place of the color camera
  double units_per_meter = 1000;
};

/// Makes a scan of a depth image: a point a pixel, all at the scan's stamp. Pixels beside a jump in depth are left out: there,
/// a depth camera measures neither surface but something in between ("flying pixels"). InputError where the file is no such
/// image, is of another size, holds no depth, or holds depths that no depth camera measures, such as meters.
struct DepthScan {
  Camera camera;  ///< of the depth images
  SE3 lidar_from_depth;
  double units_per_meter = 1000;

  Scan operator()(const ScanHeader& header) const;
  /// The same of an image that is no file of its own; `name` is for messages.
  Scan operator()(const cv::Mat1w& image, const fs::path& name) const;
};

/// Sets the sensor of a drive whose scans are depth images, and returns what reads them. `camera`, `camera_from_lidar` and the
/// scans are set. InputError where the first depth image is of another size than its camera, with the remedy.
DepthScan attach_depth_camera(Drive& drive, const DepthCamera& depth);

/// The same for depth images of that size that are no files of their own; `name` is for messages.
DepthScan depth_scan_of(Drive& drive, const DepthCamera& depth, cv::Size size, const fs::path& name);

}  // namespace dvi::datasets
