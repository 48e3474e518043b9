#include "dvi/odometry/alignment_criteria.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "dvi/geometry/skew.h"

namespace dvi::odometry {
namespace {

/// Adds the errors that neighboring pixels share and those of the camera model to the covariance of an alignment.
Matrix6d add_model_errors(const Matrix6d& information, double turn_rad_s) {
  constexpr AlignmentErrorParams kErrors;
  const double shutter_rad = kErrors.shutter_s * turn_rad_s, shutter_m = kErrors.depth_m * shutter_rad;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(kErrors.sigma_m * kErrors.sigma_m + shutter_m * shutter_m),
      Eigen::Vector3d::Constant(kErrors.sigma_rad * kErrors.sigma_rad + shutter_rad * shutter_rad);
  const Matrix6d covariance = (information / kErrors.pixels_per_error + 1e-3 * Matrix6d::Identity()).inverse();
  return (covariance + variance.asDiagonal().toDenseMatrix()).inverse();
}

}  // namespace

bool AlignmentCriteria::accept(const Alignment& alignment) const {
  if (alignment.inlier_share() < inlier_share || alignment.overlap() < overlap) return false;
  if (alignment.gray_points > 0 && alignment.correlation < correlation) return false;
  const Matrix6d covariance = compute_information_in_reference(alignment, 0).inverse();
  const auto largest = [&](int first) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.block<3, 3>(first, first));
    return std::sqrt(solver.eigenvalues()[2]);
  };
  return largest(0) < sigma_m && largest(3) < sigma_rad;
}

Matrix6d compute_information_in_reference(const Alignment& alignment, double turn_rad_s) {
  return add_model_errors(alignment.information, turn_rad_s);
}

Matrix6d compute_information_in_current(const Alignment& alignment, double turn_rad_s) {
  const SE3& pose = alignment.reference_from_current;
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = pose.R;
  adjoint.topRightCorner<3, 3>() = skew(pose.t) * pose.R;
  return add_model_errors(adjoint.transpose() * alignment.information * adjoint, turn_rad_s);
}

}  // namespace dvi::odometry
