#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/matx.hpp>

#include "dvi/drive/drive.h"

namespace dvi {

/// A return in an image: its image coordinates u and v, and its depth in meters (Camera::depth()).
using ImageReturn = cv::Vec3f;

/// Projects the returns of the scan nearest in time into a frame. Returns nothing if there is no scan within 100 ms, or no
/// pose.
std::vector<ImageReturn> project_returns(const Drive& drive, std::size_t frame, const Trajectory& world_from_lidar);

}  // namespace dvi
