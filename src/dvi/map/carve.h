#pragma once

#include <vector>

#include "dvi/map/build_map.h"
#include "dvi/map/map_voxel.h"

namespace dvi::map {

/// Counts for every voxel in how many sweeps rays ended at it and in how many they went on behind it (map/free_space.h).
/// Streams over scans; one tick a scan. After DUFOMap (Duberg et al. 2024): what was once seen to be free does not belong to
/// the static map, where free is claimed only within the errors of sensor and poses.
void see_through(MapVoxels& voxels, const std::vector<MapInput>& inputs, double pose_error_m, const Tick& tick);

/// Whether the rays say that what a voxel holds did not stay there.
bool has_moved(const MapVoxel& voxel);

}  // namespace dvi::map
