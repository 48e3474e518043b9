#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/image_returns.h"

namespace dvi::depth {

/// Finds the things in front of the static map in a view: groups of returns of its own scan that are clearly nearer than the
/// map, with the gaps between the rays closed. Such things hide the background at this time, whether masks show them or not.
/// Returns 255 where they are.
cv::Mat1b find_occluders(const DepthMap& depth, const std::vector<ImageReturn>& returns);

}  // namespace dvi::depth
