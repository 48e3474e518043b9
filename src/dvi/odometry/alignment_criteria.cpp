#include "dvi/odometry/alignment_criteria.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "dvi/geometry/skew.h"

namespace dvi::odometry {
namespace {

/// Neither neighboring pixels nor distortion and rolling shutter make a pose better known than to these standard deviations.
Matrix6d no_better_than_model(const Matrix6d& information) {
  constexpr double kModelM = 0.003, kModelRad = 0.0015, kPixelsPerError = 10;
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(kModelM * kModelM), Eigen::Vector3d::Constant(kModelRad * kModelRad);
  const Matrix6d covariance = (information / kPixelsPerError + 1e-3 * Matrix6d::Identity()).inverse();
  return (covariance + variance.asDiagonal().toDenseMatrix()).inverse();
}

}  // namespace

bool AlignmentCriteria::accept(const Alignment& alignment) const {
  if (alignment.inlier_share() < inlier_share || alignment.overlap() < overlap) return false;
  if (alignment.gray_points > 0 && alignment.correlation < correlation) return false;
  const Matrix6d covariance = information_in_reference(alignment).inverse();
  const auto largest = [&](int first) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance.block<3, 3>(first, first));
    return std::sqrt(solver.eigenvalues()[2]);
  };
  return largest(0) < sigma_m && largest(3) < sigma_rad;
}

Matrix6d information_in_reference(const Alignment& alignment) { return no_better_than_model(alignment.information); }

Matrix6d information_in_current(const Alignment& alignment) {
  const SE3& pose = alignment.reference_from_current;
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = pose.R;
  adjoint.topRightCorner<3, 3>() = skew(pose.t) * pose.R;
  return no_better_than_model(adjoint.transpose() * alignment.information * adjoint);
}

}  // namespace dvi::odometry
