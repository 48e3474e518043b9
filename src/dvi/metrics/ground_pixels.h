#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi::metrics {

/// Finds the pixels of a depth map (z in meters * 256, 0 = unknown, as in depth/NAME.png) that show the ground: those at most a
/// fifth of the camera's height above the largest plane below the camera. The inverse depth of a plane is linear in image
/// coordinates, so neither the camera nor its pose is required. Returns a mask, or an empty image if no plane is found.
cv::Mat1b find_ground_pixels(const cv::Mat1w& depth);

}  // namespace dvi::metrics
