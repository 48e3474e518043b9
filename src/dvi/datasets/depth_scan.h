#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The camera that took depth images, and the meaning of their values: 16-bit PNG with the depth along the optical axis. 0 and
/// 65535 mean that there is no depth.
struct DepthCamera {
  std::optional<Camera> camera = {};         ///< none: its pixels are those of the color images
  std::optional<SE3> depth_from_color = {};  ///< none: the depth is registered to the color camera
  double units_per_meter = 1000;
};

/// Makes scans of depth images: one point per pixel, all at the scan's stamp. Pixels beside a jump in depth are left out,
/// because a depth camera measures values between both surfaces there ("flying pixels"). Throws InputError if the file is not a
/// 16-bit depth image, differs in size from its camera, holds no depth, or holds depths outside the range of depth cameras,
/// such as meters.
struct DepthScan {
  Camera camera;  ///< of the depth images
  SE3 lidar_from_depth;
  double units_per_meter = 1000;

  Scan operator()(const ScanHeader& header) const;
  /// Does the same for an image that is not a file of its own; `name` is used in messages.
  Scan operator()(const cv::Mat1w& image, const fs::path& name) const;
};

/// Sets the sensor of a drive whose scans are depth images, and returns their reader. The drive's `camera`, `camera_from_lidar`
/// and scans have to be set. Throws InputError if the first depth image differs in size from its camera.
DepthScan attach_depth_camera(Drive& drive, const DepthCamera& depth);

/// Does the same for depth images of the given size that are not files of their own; `name` is used in messages.
DepthScan make_depth_scan(Drive& drive, const DepthCamera& depth, cv::Size size, const fs::path& name);

}  // namespace dvi::datasets
