#pragma once

#include <cstddef>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/holdout/driven_path.h"

namespace dvi::holdout {

/// Counts the returns of all scans inside a box of this size (length, width, height) on the road, for each position along the
/// road (meters), `left` meters to the left of the path. Returns below 0.3 m are ground; returns within 0.2 m of the box count
/// as inside. Returns in the boxes of moving labels do not count. Reads the scans near the positions.
std::vector<std::size_t> count_returns_inside(const Drive& drive, const Trajectory& world_from_lidar, const DrivenPath& road,
                                              const Eigen::Vector3d& size, const std::vector<double>& along, double left);

}  // namespace dvi::holdout
