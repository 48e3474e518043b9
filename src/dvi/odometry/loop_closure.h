#pragma once

#include <vector>

#include "dvi/odometry/odometry.h"

namespace dvi::odometry {

/// A place that the drive came back to.
struct Loop {
  std::size_t earlier = 0, later = 0;  ///< of the odometry's poses
  SE3 earlier_from_later;
  Matrix6d information = Matrix6d::Zero();  ///< as in Registration
};

/// Pairs of poses a long drive apart that odometry puts near each other and whose scans fit together: the later scan is held
/// against a map of the earlier ones, from starts all over the place, and must fit nearly as well as a scan of its own time
/// does, and so must one a little before it. A depth camera comes back where it looks the same way. `options` suit the
/// drive (suited). Reads the scans it needs again. One tick a pose.
std::vector<Loop> find_loops(
    const Drive& drive, const OdometryOptions& options, const Odometry& odometry, const Tick& tick = [] {});

/// Moves the odometry's poses so that loops close (pose_graph.h), the first stays. Without loops nothing changes.
/// One tick a pose.
void close_loops(const Drive& drive, const OdometryOptions& options, Odometry& odometry, const Tick& tick = [] {});

}  // namespace dvi::odometry
