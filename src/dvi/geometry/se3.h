#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dvi {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A rigid motion, named target_from_source: x_in_target = R x_in_source + t.
struct SE3 {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return R * x + t; }
  SE3 operator*(const SE3& other) const { return {R * other.R, R * other.t + t}; }
  SE3 inverse() const { return {R.transpose(), -(R.transpose() * t)}; }
};

/// Converts a rotation vector w to its rotation (Rodrigues), and back for angles below pi.
Eigen::Matrix3d so3_exp(const Eigen::Vector3d& w);
Eigen::Vector3d so3_log(const Eigen::Matrix3d& R);

/// The exponential map of a twist (translation part rho, rotation part phi), and its inverse.
SE3 se3_exp(const Vector6d& twist);
Vector6d se3_log(const SE3& pose);

/// Interpolates between the poses a (u = 0) and b (u = 1) along the screw between them; extrapolates for u outside [0, 1].
SE3 interpolate(const SE3& a, const SE3& b, double u);

/// Returns the rotation nearest to a matrix, such as one that was printed with few digits.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m);

}  // namespace dvi
