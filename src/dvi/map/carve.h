#pragma once

#include <vector>

#include "dvi/map/build_map.h"
#include "dvi/map/map_voxel.h"

namespace dvi::map {

/// What the rays of each drive say of every voxel, by hit and pass-through counts: scans whose rays ended in it, and scans
/// whose rays passed it (drive/free_space.h). Drives are counted apart: what stood all one day and was gone on another belongs
/// to the map of the first day only. Streams over scans; one tick a scan. After DUFOMap (Duberg et al. 2024): what was once
/// seen to be free does not belong to the static map, where free is claimed only within the errors of sensor and poses.
void count_hits_and_passes(MapVoxels& voxels, const std::vector<MapInput>& inputs, double pose_error_m, const Tick& tick);

/// Whether rays passed through the voxel too often for what it holds to be static, and on no day it was.
bool has_moved(const MapVoxel& voxel);

}  // namespace dvi::map
