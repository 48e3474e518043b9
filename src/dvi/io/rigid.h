#pragma once

#include <array>
#include <optional>

#include "dvi/geometry/se3.h"

namespace dvi::io {

/// What few digits may cost a rotation that was written as text.
inline constexpr double kPrintedRotation = 1e-3;

/// The motion of a 3x4 matrix (row-major) whose left part is a rotation but for rounding; none if it is not.
inline std::optional<SE3> to_rigid(const std::array<double, 12>& m) {
  Eigen::Matrix3d R;
  R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  const Eigen::Matrix3d nearest = nearest_rotation(R);
  if (!((nearest - R).cwiseAbs().maxCoeff() <= kPrintedRotation)) return std::nullopt;
  return SE3{nearest, {m[3], m[7], m[11]}};
}

/// The 3x4 matrix [R t], row by row, as files hold it.
inline std::array<double, 12> row_major(const SE3& pose) {
  std::array<double, 12> out;
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(out.data());
  matrix << pose.R, pose.t;
  return out;
}

}  // namespace dvi::io
