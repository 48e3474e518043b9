#pragma once

#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Whether the scans lie sharper on each other if the times of their points are not used (they are compensated for the motion
/// already), or run backwards (the LiDAR turns the other way). Empty where they do not, where the drive hardly moves, or where
/// all points of a scan have one time. In words, with both spreads and the remedy.
std::vector<std::string> scan_time_doubts(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::diagnostics
