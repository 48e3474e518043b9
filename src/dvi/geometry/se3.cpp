#include "dvi/geometry/se3.h"

#include <cmath>

#include <Eigen/SVD>

#include "dvi/geometry/skew.h"

namespace dvi {
namespace {

constexpr double kSmallAngle = 1e-8;
constexpr double kSeriesAngle = 1e-4;  // below it, 1 - cos loses half of its digits, and the next term of the series is 1e-13

// Returns the left Jacobian of SO(3): the translation of exp(rho, phi) is J(phi) rho.
Eigen::Matrix3d compute_left_jacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d k = skew(phi);
  if (angle < kSeriesAngle) return Eigen::Matrix3d::Identity() + 0.5 * k + k * k / 6;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / a2 * k + (angle - std::sin(angle)) / (a2 * angle) * k * k;
}

}  // namespace

Eigen::Matrix3d so3_exp(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < kSmallAngle) return nearest_rotation(Eigen::Matrix3d::Identity() + skew(w));
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Vector3d so3_log(const Eigen::Matrix3d& R) {
  // The quaternion is well conditioned near zero as well as near pi.
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  return s < kSmallAngle ? Eigen::Vector3d(2 * q.vec()) : Eigen::Vector3d(2 * std::atan2(s, q.w()) / s * q.vec());
}

SE3 se3_exp(const Vector6d& twist) {
  const Eigen::Vector3d phi = twist.tail<3>();
  return {so3_exp(phi), compute_left_jacobian(phi) * twist.head<3>()};
}

Vector6d se3_log(const SE3& pose) {
  Vector6d twist;
  twist.tail<3>() = so3_log(pose.R);
  twist.head<3>() = compute_left_jacobian(twist.tail<3>()).inverse() * pose.t;
  return twist;
}

SE3 interpolate(const SE3& a, const SE3& b, double u) { return a * se3_exp(u * se3_log(a.inverse() * b)); }

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d d(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  return svd.matrixU() * d.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace dvi
