#pragma once

#include <vector>

#include "dvi/map/build_map.h"
#include "dvi/map/map_voxel.h"

namespace dvi::map {

/// Adds the map that a drive brings to the voxels, as far from its path as scans are used, and a scan without returns for each
/// of its frames: the nearest to a point stands for what saw it. Returns how many points were added.
std::size_t add_given(const MapInput& input, const MapOptions& options, std::size_t drive, std::vector<MapScan>& scans,
                      MapVoxels& voxels);

/// How many points of that map lie so near its path, and how far the nearest one is from it. The path: world_from_lidar.
struct GivenReach {
  std::size_t points = 0, near = 0;
  double nearest_m = 0;  ///< from the path's first pose; where none is near
};
GivenReach reach_of_given(const Drive& drive, const MapOptions& options);

}  // namespace dvi::map
