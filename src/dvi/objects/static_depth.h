#pragma once

#include <memory>

#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// What stands in a drive, as its views see it at half their size: meters along the optical axis to the nearest return above
/// the ground that the scans of a second before and after have of it; 0 where there is none. Returns within the boxes of
/// `objects` (as the drive's frames) do not count. On demand, as `views`.
Lazy<cv::Mat1f> static_depth(const Drive& drive, const Trajectory& world_from_lidar, const SharedLabels& objects,
                             const Views& views, const std::shared_ptr<const ground::ScanGround>& ground);

}  // namespace dvi::objects
