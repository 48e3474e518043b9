#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "dvi/map/voxel_grid.h"

namespace dvi::map {

/// What the returns of one voxel add up to, and what rays saw of it.
struct MapVoxel {
  Eigen::Vector3f offset_sum = Eigen::Vector3f::Zero();  ///< of the returns from the voxel's center, meters
  float intensity_sum = 0;
  std::uint32_t count = 0;
  std::uint32_t first = 0, last = 0;    ///< scans, by their number in StaticMap::scans
  std::uint16_t hits = 0, passes = 0;   ///< hit and pass-through counts, in scans of the drive that is being counted
  std::uint32_t absent = 0, stood = 0;  ///< MapPoint::drive_bit() of the drives counted: what their rays say of it
};

using MapVoxels = VoxelGrid<MapVoxel>;

/// The mean of its returns, in world axes.
inline Eigen::Vector3d mean(const MapVoxels& grid, const Eigen::Vector3i& place, const MapVoxel& voxel) {
  return grid.center(place) + (voxel.offset_sum / static_cast<float>(voxel.count)).cast<double>();
}

}  // namespace dvi::map
