#pragma once

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/ground/scan_ground.h"
#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The moving objects of a drive.
struct FoundTraffic {
  std::vector<Track> tracks;
  std::vector<std::size_t>
      contradictory;  ///< Scans whose poses cannot be right (find_contradictory_scans()); nothing is found there.
};

/// Finds moving objects without labels: returns where other scans observed free space, grouped, tracked over time, also while
/// they stand still before or after they move. One tick per scan.
FoundTraffic find_traffic(const Drive& drive, const ScanPoses& poses, const ground::ScanGround& ground, const Tick& tick);

/// The outlines of tracks in the images of a drive, as its frames; track: its index in `tracks`. `footprint_m`: ground round an
/// object that belongs to it, its wheels and the darkest of its shadow, meters.
FrameLabels outlines(const std::vector<Track>& tracks, const Drive& drive, const Trajectory& world_from_lidar,
                     double footprint_m);

}  // namespace dvi::objects
