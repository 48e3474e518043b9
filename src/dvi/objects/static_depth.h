#pragma once

#include <memory>

#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// The scans of a drive, and the objects that do not belong to its static surfaces. It refers to the drive and its poses, which
/// must outlive it and the depth maps rendered from it.
struct StaticScene {
  const Drive& drive;
  const Trajectory& world_from_lidar;
  SharedLabels objects;  ///< per frame; returns within their boxes are left out
  std::shared_ptr<const ground::ScanGround> ground;
};

/// Renders the static surfaces of a drive into its views at half size: the depth in meters of the nearest return above the
/// ground, from the scans of a second before and after; 0 where there is none. Per view, on demand.
Lazy<cv::Mat1f> render_static_depth(const StaticScene& scene, const Views& views);

}  // namespace dvi::objects
