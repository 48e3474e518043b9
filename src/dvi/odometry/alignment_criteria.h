#pragma once

#include "dvi/odometry/direct_alignment.h"

namespace dvi::odometry {

/// What an alignment must reach: shares of points, the correlation of gray levels, and standard deviations of the pose in the
/// direction that the scene constrains least.
struct AlignmentCriteria {
  double inlier_share = 0, correlation = 0, overlap = 0;
  double sigma_m = 0.02, sigma_rad = 0.01;

  bool accept(const Alignment& alignment) const;
};

/// From one image to the next.
inline constexpr AlignmentCriteria kReliable{0.7, 0.7, 0.25};
/// Where only the images themselves say that they show the same place.
inline constexpr AlignmentCriteria kCertain{0.75, 0.75, 0.4};
/// Below, another start may lead to a better alignment.
inline constexpr AlignmentCriteria kGood{0.92, 0.94, 0.25};

/// The inverse covariance of an alignment, translation and rotation, in the axes of the reference and of the current camera.
/// It allows for errors that neighboring pixels share, and for what the camera model leaves out, such as a rolling shutter:
/// `turn_rad_s` is the faster rotation of the two cameras.
Matrix6d information_in_reference(const Alignment& alignment, double turn_rad_s);
Matrix6d information_in_current(const Alignment& alignment, double turn_rad_s);

}  // namespace dvi::odometry
