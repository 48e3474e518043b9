#pragma once

#include <array>
#include <optional>

#include "dvi/geometry/plausible.h"
#include "dvi/geometry/se3.h"

namespace dvi {

/// The left part of a 3x4 matrix (row-major).
inline Eigen::Matrix3d left_part(const std::array<double, 12>& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(m.data()).leftCols<3>();
}

/// The motion of a 3x4 matrix whose left part is a rotation but for rounding; none if rotation_problem() finds fault with it.
inline std::optional<SE3> to_rigid(const std::array<double, 12>& m) {
  const Eigen::Matrix3d R = left_part(m);
  if (!rotation_problem(R).empty()) return std::nullopt;
  constexpr double kExact = 1e-14;  // written with all digits: it is to be read back as it was
  const bool exact = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kExact;
  return SE3{exact ? R : nearest_rotation(R), {m[3], m[7], m[11]}};
}

/// The 3x4 matrix [R t], row by row, as files hold it.
inline std::array<double, 12> row_major(const SE3& pose) {
  std::array<double, 12> out;
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(out.data());
  matrix << pose.R, pose.t;
  return out;
}

}  // namespace dvi
