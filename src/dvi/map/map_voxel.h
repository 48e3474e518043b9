#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/map/static_map.h"
#include "dvi/map/voxel_grid.h"

namespace dvi::map {

/// The sums over the returns of one voxel, and the evidence of rays.
struct MapVoxel {
  Eigen::Vector3f offset_sum = Eigen::Vector3f::Zero();  ///< offsets of the returns from the center of the voxel, meters
  float intensity_sum = 0;
  std::uint32_t count = 0;
  std::uint32_t first = 0, last = 0;      ///< indices in StaticMap::scans
  std::uint16_t hits = 0, passes = 0;     ///< scans of the current drive with rays that ended in the voxel or passed through it
  std::uint32_t absent = 0, present = 0;  ///< MapPoint::drive_bit() of the drives whose rays show it absent or present
};

using MapVoxels = VoxelGrid<MapVoxel>;

/// The voxels of a map, and the scans to which they refer.
struct ObservedVoxels {
  MapVoxels voxels;
  std::vector<MapScan> scans;
};

/// Returns the mean of the returns of a voxel, in the world.
inline Eigen::Vector3d compute_mean(const MapVoxels& grid, const Eigen::Vector3i& index, const MapVoxel& voxel) {
  return grid.center(index) + (voxel.offset_sum / static_cast<float>(voxel.count)).cast<double>();
}

}  // namespace dvi::map
