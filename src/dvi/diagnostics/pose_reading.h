#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/diagnostics/scan_tracks.h"

namespace dvi::diagnostics {

/// Another reading of given poses, which the scans bear out while they contradict the poses as given.
struct PoseReading {
  std::string words;                 ///< what the poses look like, and the remedy
  double as_given = 0, as_read = 0;  ///< disagreement with the scans' motion: 0 none, 1 as much as the motion itself
};

/// Holds the motion between given poses (world_from_lidar) against the scans': as they are, inverted, as poses of the camera,
/// and about other axes. None where they agree as they are, where no other reading is clearly better, or where the drive hardly
/// moves.
std::optional<PoseReading> better_reading(const Trajectory& given, const SE3& camera_from_lidar,
                                          const std::vector<ScanTrack>& tracks);

}  // namespace dvi::diagnostics
