#pragma once

#include <array>

#include "dvi/geometry/se3.h"

namespace dvi {

/// A 3D box. `frame_from_box` has its center and axes (x along its length); `size` is its full size in meters.
struct Box {
  SE3 frame_from_box;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();

  /// Returns whether a point of the frame lies inside the box after it is enlarged by `margin` on all sides.
  bool contains(const Eigen::Vector3d& x, double margin = 0) const {
    const Eigen::Vector3d local = frame_from_box.R.transpose() * (x - frame_from_box.t);
    return ((local.cwiseAbs() - 0.5 * size).array() <= margin).all();
  }
  /// Returns the corners in axes of the frame.
  std::array<Eigen::Vector3d, 8> corners() const {
    std::array<Eigen::Vector3d, 8> out;
    for (int i = 0; i < 8; ++i)
      out[i] = frame_from_box * (0.5 * size.cwiseProduct(Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
    return out;
  }
};

}  // namespace dvi
