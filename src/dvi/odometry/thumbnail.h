#pragma once

#include "dvi/odometry/rgbd_image.h"

namespace dvi::odometry {

/// A small, blurred gray image (of inverse depths if there is no color) by which views are recognized.
struct Thumbnail {
  Pinhole camera;
  cv::Mat1f gray;
};

/// Makes a thumbnail from the coarsest level of an image.
Thumbnail make_thumbnail(const RgbdImage& image);

/// How similar two thumbnails are after the rotation that makes them most similar.
struct ThumbnailMatch {
  double correlation = -1;  ///< -1 to 1; does not depend on the exposure
  Eigen::Matrix3d a_from_b = Eigen::Matrix3d::Identity();
};

/// Finds the rotation by exhaustive search over shifts of the image and rolls up to `max_roll_deg`. Two views from one place
/// are recognized as Klein and Murray do to recover a lost track ("Improving the agility of keyframe-based SLAM", ECCV 2008).
ThumbnailMatch match(const Thumbnail& a, const Thumbnail& b, double max_roll_deg);

}  // namespace dvi::odometry
