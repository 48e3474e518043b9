#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/odometry/odometry.h"

namespace dvi::diagnostics {

/// The LiDAR's motion over a stretch of scans, by the scans alone.
struct ScanTrack {
  std::size_t first = 0, last = 0;  ///< scans of the drive, last excluded
  Trajectory world_from_lidar;      ///< each track has a world of its own
};

/// At most three stretches, evenly spread, by odometry without given poses. A stretch is left out where the scene does not hold
/// every direction of motion, or the odometry lost its way: given poses must not be doubted there. One tick a stretch.
std::vector<ScanTrack> scan_tracks(const Drive& drive, odometry::OdometryOptions options, const Tick& tick = [] {});
std::size_t scan_tracks_ticks(const Drive& drive);

}  // namespace dvi::diagnostics
