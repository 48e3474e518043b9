#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/odometry/odometry.h"

namespace dvi::diagnostics {

/// The motion of the LiDAR over a section of the drive, estimated from the scans alone.
struct ScanTrack {
  std::size_t first = 0, last = 0;  ///< scans of the drive; last is excluded
  Trajectory world_from_lidar;      ///< each track has its own world
};

/// Parameters of the selection of sections.
struct ScanTrackParams {
  std::size_t scans = 20;        ///< of a section
  std::size_t max_sections = 3;  ///< evenly spaced
  std::size_t min_scans = 5;     ///< of a drive and of a track
};
inline constexpr ScanTrackParams kScanTrack;

/// Runs odometry without given poses over at most three sections of the drive. Leaves out a section if the scene does not
/// constrain all directions of motion or if odometry is lost, because given poses cannot be checked there. Calls `tick` once
/// per section, count_scan_track_ticks() times in all.
std::vector<ScanTrack> estimate_scan_tracks(const Drive& drive, odometry::OdometryOptions options, const Tick& tick = [] {});
std::size_t count_scan_track_ticks(const Drive& drive);

}  // namespace dvi::diagnostics
