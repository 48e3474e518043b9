#pragma once

#include <Eigen/Core>

namespace dvi {

/// The skew-symmetric matrix of the cross product: skew(v) x = v.cross(x).
inline Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace dvi
