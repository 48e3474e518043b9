#pragma once

#include "dvi/core/interrupt.h"
#include "dvi/core/options.h"
#include "dvi/traffic/ground.h"
#include "dvi/traffic/tracks.h"

namespace dvi::traffic {

/// What moves in a drive.
struct Traffic {
  std::vector<Track> tracks;
  FrameLabels labels;  ///< as the drive's frames; track: its index in `tracks`
};

/// What allowances are made for, in metres.
struct Allowances {
  double pose_error_m;  ///< of poses between scans, across a ray
  double footprint_m;   ///< of ground round an object: its wheels, and the darkest of its shadow
};

/// Finds moving objects without labels: returns where other scans saw free space, grouped, tracked over time, and their
/// outlines in the images. One tick a scan.
Traffic find_traffic(const Drive& drive, const Trajectory& world_from_lidar, const Ground& ground, const Allowances& allowances,
                     const Tick& tick);

}  // namespace dvi::traffic
