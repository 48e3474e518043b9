#pragma once

#include <cstddef>

#include "dvi/map/build_map.h"
#include "dvi/map/map_voxel.h"

namespace dvi::map {

/// Adds the points of the map that a drive brings to the voxels, within the range of scans from its path. Adds a scan without
/// returns for each frame, because each point refers to the scan that observed it. Returns the number of points added.
std::size_t add_given_points(const MapInput& input, const MapOptions& options, std::size_t drive, ObservedVoxels& sums);

/// How many points of that map are within the range of scans from the path.
struct GivenCoverage {
  std::size_t points = 0, near = 0;
  double nearest_m = 0;  ///< distance of the nearest point from the first pose
};
/// Measures the coverage with the poses of the drive.
GivenCoverage measure_given_coverage(const Drive& drive, const MapOptions& options);

}  // namespace dvi::map
