#pragma once

#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Parameters of the check for fast rotations.
struct FastMotionParams {
  double readout_s = 0.03;  ///< time from the first to the last row of a rolling shutter at 30 Hz
  double max_skew_px = 15;  ///< the first and last rows are displaced by half of it
};
inline constexpr FastMotionParams kFastMotion;

/// Finds the frames of a depth camera during which it rotates so fast that images are blurred and, with a rolling shutter,
/// skewed by more than dvi corrects. Returns a warning with the frames and the largest skew; nothing if there are no such
/// frames, and for a LiDAR drive.
std::vector<std::string> check_fast_motion(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::diagnostics
