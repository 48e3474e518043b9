#pragma once

#include "dvi/odometry/direct_alignment.h"

namespace dvi::odometry {

/// The thresholds for an alignment: minimum shares of points and correlation of gray levels, and maximum standard deviations of
/// the pose in the direction that the scene constrains least.
struct AlignmentCriteria {
  double inlier_share = 0, correlation = 0, overlap = 0;
  double sigma_m = 0.02, sigma_rad = 0.01;

  bool accept(const Alignment& alignment) const;
};

/// Errors of an alignment that its residuals do not show.
struct AlignmentErrorParams {
  double sigma_m = 0.003;        ///< of the camera model
  double sigma_rad = 0.0015;     ///< likewise
  double pixels_per_error = 10;  ///< neighboring pixels that share one error
  double shutter_s = 0.005;      ///< time error by a rolling shutter, which reads an image in up to 30 ms
  double depth_m = 2;            ///< depth at which a rotation error becomes a translation error
};

/// For an alignment from one image to the next.
inline constexpr AlignmentCriteria kReliable{0.7, 0.7, 0.25};
/// For loops and recovery, where only the images show that they are of the same place.
inline constexpr AlignmentCriteria kCertain{0.75, 0.75, 0.4};
/// Below these thresholds, another initial guess may lead to a better alignment.
inline constexpr AlignmentCriteria kGood{0.92, 0.94, 0.25};

/// Return the inverse covariance of an alignment, translation and rotation, in the axes of the reference and of the current
/// camera. It includes errors that neighboring pixels share and errors that the camera model omits, such as a rolling shutter.
/// `turn_rad_s` is the rotation speed of the faster camera.
Matrix6d compute_information_in_reference(const Alignment& alignment, double turn_rad_s);
Matrix6d compute_information_in_current(const Alignment& alignment, double turn_rad_s);

}  // namespace dvi::odometry
