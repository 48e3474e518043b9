#pragma once

#include <cstddef>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/holdout/driven_path.h"

namespace dvi::holdout {

/// How many returns of all scans lie inside a thing of this size (length, width, height) that stands on the road, for each
/// place (meters along it) at which it might, `left` of the path. What is below 0.3 m is ground, what is nearer than 0.2 m
/// counts as inside. Traffic counts too, but for what lies in boxes that labels move. Reads the scans that came near.
std::vector<std::size_t> returns_inside(const Drive& drive, const Trajectory& world_from_lidar, const DrivenPath& road,
                                        const Eigen::Vector3d& size, const std::vector<double>& places, double left);

}  // namespace dvi::holdout
