#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/drive/drive.h"

namespace dvi {

/// Transforms the points of a scan to world axes, each by the sensor's pose at its own time within the scan. Returns nothing if
/// the trajectory does not cover the scan. Transforms only each `every`-th point; the others are unset.
std::vector<Eigen::Vector3d> to_world(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar,
                                      std::size_t every = 1);

}  // namespace dvi
