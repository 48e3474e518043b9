#pragma once

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/traffic/ground.h"
#include "dvi/traffic/tracks.h"

namespace dvi::traffic {

/// Finds moving objects without labels: returns where other scans saw free space, grouped, tracked over time. One tick a
/// scan.
std::vector<Track> find_traffic(const Drive& drive, const Trajectory& world_from_lidar, const Ground& ground,
                                double pose_error_m, const Tick& tick);

/// The outlines of tracks in the images of a drive, as its frames; track: its index in `tracks`. `footprint_m`: ground round an
/// object that belongs to it, its wheels and the darkest of its shadow, metres.
FrameLabels outlines(const std::vector<Track>& tracks, const Drive& drive, const Trajectory& world_from_lidar,
                     double footprint_m);

}  // namespace dvi::traffic
