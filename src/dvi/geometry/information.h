#pragma once

#include <Eigen/LU>

#include "dvi/geometry/se3.h"

namespace dvi {

/// Returns the covariance of a rigid motion with independent errors: standard deviations of the translation in meters and of
/// the rotation in radians, per axis.
inline Matrix6d to_covariance(double sigma_m, double sigma_rad) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variance.asDiagonal();
}

/// Returns the information matrix (inverse covariance) of such a motion.
inline Matrix6d to_information(double sigma_m, double sigma_rad) {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variance.cwiseInverse().asDiagonal();
}

/// Adds independent errors to a measured motion and returns its information matrix, which is no better than the errors allow.
inline Matrix6d add_errors(const Matrix6d& information, double sigma_m, double sigma_rad) {
  return (information.inverse() + to_covariance(sigma_m, sigma_rad)).inverse();
}

}  // namespace dvi
