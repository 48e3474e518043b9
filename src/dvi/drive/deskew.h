#pragma once

#include <vector>

#include <Eigen/Core>

#include "dvi/drive/drive.h"

namespace dvi {

/// The points of a scan in world axes, each placed by the sensor's pose at its own time within the scan. Empty where the
/// trajectory does not cover the scan.
std::vector<Eigen::Vector3d> to_world(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar);

}  // namespace dvi
