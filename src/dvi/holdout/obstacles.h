#pragma once

#include <cstddef>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/holdout/driven_path.h"

namespace dvi::holdout {

/// Boxes of one size on the road, at several positions along it.
struct RoadBoxes {
  const DrivenPath& road;
  Eigen::Vector3d size;       ///< length, width, height
  std::vector<double> along;  ///< meters along the road
  double left = 0;            ///< meters to the left of the path
};

/// Counts the returns of all scans inside each box. Returns below 0.3 m are ground; returns within 0.2 m of the box count as
/// inside. Returns in the boxes of moving labels do not count. Reads the scans near the positions.
std::vector<std::size_t> count_returns_inside(const Drive& drive, const Trajectory& world_from_lidar, const RoadBoxes& places);

}  // namespace dvi::holdout
