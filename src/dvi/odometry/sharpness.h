#pragma once

#include <cstddef>

#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"

namespace dvi::odometry {

/// Parameters of the measurement of sharpness.
struct SharpnessParams {
  std::size_t scans_per_section = 20;  ///< consecutive scans that are compared
  std::size_t max_sections = 3;        ///< evenly spaced along the drive
  std::size_t point_step = 2;          ///< every second point is used
  float min_range_m = 3;
  float max_range_m = 40;
  double patch_m = 0.8;               ///< edge of the cubes that hold the patches
  double max_plane_distance_m = 0.2;  ///< points farther from the plane belong to another surface
  double min_plane_share = 0.85;      ///< share of a patch's points near the plane
  double min_width_m = 0.12;          ///< standard deviation across; a narrower patch is a line
  double max_tilt_deg = 10;           ///< of a ground patch, and of a vertical one
  std::size_t min_scans = 5;          ///< of a patch
  std::size_t min_points = 30;        ///< of a patch
  std::size_t min_points_per_scan = 4;
};
inline constexpr SharpnessParams kSharpness;

/// How much the scans of a drive disagree on the position of planar surfaces: the spread of the scans' mean distances to the
/// plane of a patch, minus the part that noise within each scan explains; the median over patches. A negative value means that
/// noise explains more than the spread.
struct Sharpness {
  double ground_m = 0, vertical_m = 0;
  std::size_t ground_patches = 0, vertical_patches = 0;

  /// Returns the root of the sum of squares, by which trajectories are compared.
  double total_m() const;
  bool known() const { return ground_patches + vertical_patches >= 20; }
};

/// Measures the sharpness over at most three sections of the drive. Each point is placed by the trajectory at its own time.
/// Calls `tick` once per scan, count_sharpness_ticks() times in all.
Sharpness measure_sharpness(const Drive& drive, const Trajectory& world_from_lidar, const Tick& tick = [] {});
std::size_t count_sharpness_ticks(const Drive& drive);

}  // namespace dvi::odometry
