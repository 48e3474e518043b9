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

/// Reprojects the mask of one camera of a rig to another camera, at the same time. The result is 255 where the other camera may
/// show masked surfaces, or surfaces outside the first image, for which no mask exists. Masked surfaces have the depth of the
/// nearest returns in and around each block of the mask. `returns` are those of the scan, world axes. Without returns in the
/// first image, all pixels are 255.
cv::Mat1b reproject_mask(const cv::Mat1b& mask, const RigCamera& masked, const RigCamera& other,
                         const std::vector<Eigen::Vector3d>& returns);

/// Images of the cameras of a rig belong together if their times differ by at most this much, in which objects at 15 m/s move
/// 0.3 m.
constexpr std::int64_t kMaxRigGapNs = 20'000'000;

/// Reprojects the masks of a drive's own camera (`own`, per frame) to another camera of the rig, per frame of `other`. A frame
/// without an image of the own camera at the same time is masked completely.
Lazy<cv::Mat1b> reproject_masks(const Drive& drive, const Lazy<cv::Mat1b>& own, const Drive& other,
                                const Trajectory& world_from_lidar);

}  // namespace dvi::objects
