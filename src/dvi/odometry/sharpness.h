#pragma once

#include <cstddef>

#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"

namespace dvi::odometry {

/// How far the scans of a drive disagree on where flat things are: per patch of a meter the spread of the scans' mean
/// distances to the patch's plane, less what the noise within each scan explains; the median over patches. Negative where
/// the noise explains more than there is.
struct Sharpness {
  double ground_m = 0, vertical_m = 0;
  std::size_t ground_patches = 0, vertical_patches = 0;

  /// Root of the sum of squares; what poses are to be judged by.
  double total_m() const;
  bool known() const { return ground_patches + vertical_patches >= 20; }
};

/// Over at most three stretches of scans, evenly spread, each point placed by the trajectory at its own time. One tick a
/// scan, sharpness_ticks() in all.
Sharpness sharpness(const Drive& drive, const Trajectory& world_from_lidar, const Tick& tick = [] {});
std::size_t sharpness_ticks(const Drive& drive);

}  // namespace dvi::odometry
