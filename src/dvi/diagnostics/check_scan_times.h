#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Parameters of the check of point times.
struct ScanTimeParams {
  std::size_t scans = 12;     ///< that are compared
  double min_speed_m_s = 3;   ///< below, the motion within a scan is hardly above its noise
  double min_gain_m = 0.001;  ///< of the spread; returns and poses are the same, so that their noise is shared
  double max_relative = 0.9;  ///< of the spread as read
};
inline constexpr ScanTimeParams kScanTime;

/// Checks whether the scans agree better if the times of their points are not used (the scans are compensated already) or are
/// negated (the LiDAR rotates in the other direction). Returns a warning with both spreads and the remedy; nothing if they do
/// not, if the drive hardly moves, or if all points of a scan have the same time.
std::vector<std::string> check_scan_times(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::diagnostics
