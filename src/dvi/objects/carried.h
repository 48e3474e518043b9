#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/geometry/camera.h"
#include "dvi/geometry/se3.h"

namespace dvi::objects {

/// A camera of a rig at the time of an image.
struct RigCamera {
  Camera camera;
  SE3 camera_from_world;
};

/// The mask of one camera as another needs it that was there at the same time: 255 where the other may show what `mask` hides,
/// or what lies outside of the first one's image, of which its mask says nothing. What is hidden lies as deep as the nearest
/// returns in and round each block of the mask. `returns`: of the scan, world axes; without any in the mask, all is 255.
cv::Mat1b carried_mask(const cv::Mat1b& mask, const RigCamera& masked, const RigCamera& other,
                       const std::vector<Eigen::Vector3d>& returns);

}  // namespace dvi::objects
