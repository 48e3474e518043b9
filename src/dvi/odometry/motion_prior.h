#pragma once

#include <cstddef>
#include <optional>

#include "dvi/geometry/trajectory.h"

namespace dvi::odometry {

/// Parameters of the search for jumps in given poses.
struct MotionPriorParams {
  int neighbors = 2;                    ///< intervals before and after that are compared
  std::size_t min_intervals = 3;        ///< of all five; fewer do not show a jump
  double max_speed_change_m_s = 1.5;    ///< larger than by braking within 0.2 s
  double max_turn_change_rad_s = 0.25;  ///< larger than by steering within 0.2 s
};
inline constexpr MotionPriorParams kMotionPrior;

/// The motion of the LiDAR between two scans according to given poses. This class checks the poses for jumps; odometry checks
/// them against the scans.
class MotionPrior {
 public:
  MotionPrior() = default;  ///< without poses: motion() returns nothing
  explicit MotionPrior(Trajectory world_from_lidar) : given_(std::move(world_from_lidar)) {}

  /// Returns earlier_from_later. Returns nothing if the poses do not cover the interval, or if they jump: the velocity differs
  /// from that of intervals of the same length just before and after.
  std::optional<SE3> motion(std::int64_t earlier_ns, std::int64_t later_ns) const;

 private:
  Trajectory given_;
};

}  // namespace dvi::odometry
