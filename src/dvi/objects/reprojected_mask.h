#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"
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
/// returns in and around each block of the mask. `returns`: of the scan, world axes; without any in the mask, all is 255.
cv::Mat1b reproject_mask(const cv::Mat1b& mask, const RigCamera& masked, const RigCamera& other,
                         const std::vector<Eigen::Vector3d>& returns);

/// Images that cameras of a rig took at the same time are no farther apart; traffic at 15 m/s moves .3 m in between.
constexpr std::int64_t kMaxRigGapNs = 20'000'000;

/// The masks of a drive's own camera (`own`, as its frames), reprojected to another camera of it, as its frames. A frame of
/// which the own camera has none at the same time is masked completely.
Lazy<cv::Mat1b> reproject_masks(const Drive& drive, const Lazy<cv::Mat1b>& own, const Drive& other,
                                const Trajectory& world_from_lidar);

}  // namespace dvi::objects
