#pragma once

#include <vector>

#include "dvi/map/build_map.h"
#include "dvi/map/map_voxel.h"

namespace dvi::map {

/// Parameters of free-space carving.
struct CarvingParams {
  /// Passes per hit from which a voxel is not static. Rays pass wires and leaves now and then, but hit them more often.
  double max_pass_ratio = 0.1;
};
inline constexpr CarvingParams kCarving;

/// Counts for every voxel the scans whose rays ended in it (hits) and the scans whose rays passed through it (passes, see
/// drive/free_space.h), and concludes for each drive whether the voxel was static or absent. Drives are counted separately: an
/// object that was parked on one day and absent on another belongs to the map of the first day only. Follows DUFOMap (Duberg et
/// al. 2024): space that was observed free does not belong to the static map, within the errors of sensor and poses. Processes
/// scans one block at a time; calls `tick` once per scan.
void count_hits_and_passes(MapVoxels& voxels, const std::vector<MapInput>& inputs, double pose_error_m, const Tick& tick);

/// Returns whether the voxel was absent for at least one drive and static for none.
bool has_moved(const MapVoxel& voxel);

}  // namespace dvi::map
