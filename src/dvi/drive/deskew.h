#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/drive/drive.h"

namespace dvi {

/// The points of a scan in world axes, each placed by the sensor's pose at its own time within the scan. Empty where the
/// trajectory does not cover the scan. Only every `every`th is placed, the others are left unset.
std::vector<Eigen::Vector3d> to_world(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar,
                                      std::size_t every = 1);

}  // namespace dvi
