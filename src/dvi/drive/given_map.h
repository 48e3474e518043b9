#pragma once

#include <vector>

#include <Eigen/Core>

#include "dvi/core/cache_budget.h"

namespace dvi {

/// A static map that a drive has instead of scans: points in the world of its poses.
struct GivenMap {
  Eigen::Vector3d origin =
      Eigen::Vector3d::Zero();          ///< of `points`; far from that of the world if the latter is that of a map projection
  std::vector<Eigen::Vector3f> points;  ///< meters from `origin`, world axes
  std::vector<float> intensity;         ///< one per point

  std::size_t bytes() const { return bytes_of(points) + bytes_of(intensity); }
};

}  // namespace dvi
