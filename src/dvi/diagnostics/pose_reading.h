#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "dvi/diagnostics/scan_tracks.h"

namespace dvi::diagnostics {

/// Another convention of the given poses that agrees with the scans, while the poses as given contradict them.
struct PoseReading {
  std::string words;                 ///< the convention that the poses seem to have, and the remedy
  double as_given = 0, as_read = 0;  ///< difference from the motion of the scans, relative to that motion
};

/// Parameters of the comparison.
struct PoseReadingParams {
  std::size_t scan_step = 4;  ///< scans between two poses, so that the motion is well above the noise
  double min_motion_m = 0.3;  ///< between them, including rotation at the lever arm
  double lever_arm_m = 5;     ///< length at which a rotation counts as a translation
  std::size_t min_steps = 5;
  double min_wrong = 0.5;       ///< difference of poses that contradict the scans: 1 or more, typically
  double max_right = 0.25;      ///< difference of poses that agree: some hundredths, typically
  double min_turn_rad = 0.003;  ///< mean rotation between two poses, well above the noise of registration
  double min_wrong_turn = 1;    ///< difference of the rotations alone
  double max_right_turn = 0.5;  ///< likewise
  double min_scale_log = 0.2;   ///< logarithm of the factor of positions in other units
};
inline constexpr PoseReadingParams kPoseReading;

/// Compares the motion between given poses (world_from_lidar) with the motion of the scans: as given, inverted, as poses of the
/// camera, with other quaternions, units, and axes. Returns nothing if the poses agree as given, if no other convention is
/// clearly better, or if the drive hardly moves.
std::optional<PoseReading> find_better_reading(const Trajectory& given, const SE3& camera_from_lidar,
                                               const std::vector<ScanTrack>& tracks);

}  // namespace dvi::diagnostics
