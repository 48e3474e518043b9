#pragma once

#include <array>
#include <optional>

#include "dvi/geometry/plausible.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// Returns the left 3x3 part of a 3x4 matrix (row-major).
inline Eigen::Matrix3d get_left_part(const std::array<double, 12>& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(m.data()).leftCols<3>();
}

/// Converts a 3x4 matrix to a rigid motion if its left part is a rotation up to rounding; returns nothing if
/// describe_rotation_problem() reports a problem.
inline std::optional<SE3> to_rigid(const std::array<double, 12>& m) {
  const Eigen::Matrix3d R = get_left_part(m);
  if (!describe_rotation_problem(R).empty()) return std::nullopt;
  constexpr double kMaxRoundingError = 1e-14;  // a rotation written with all digits is read back exactly
  const bool exact = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kMaxRoundingError;
  return SE3{exact ? R : nearest_rotation(R), {m[3], m[7], m[11]}};
}

/// Returns the 3x4 matrix [R t], row by row, as in files.
inline std::array<double, 12> to_row_major(const SE3& pose) {
  std::array<double, 12> out;
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(out.data());
  matrix << pose.R, pose.t;
  return out;
}

}  // namespace dvi
