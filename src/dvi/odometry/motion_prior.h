#pragma once

#include <optional>

#include "dvi/geometry/trajectory.h"

namespace dvi::odometry {

/// The LiDAR's motion between two scans by the given poses. Poses are checked for jumps here, and against the scans where
/// they are used.
class MotionPrior {
 public:
  MotionPrior() = default;  ///< knows nothing
  explicit MotionPrior(Trajectory world_from_lidar) : given_(std::move(world_from_lidar)) {}

  /// earlier_from_later. None where poses do not reach or jump: the speed there is not that of like stretches of time right
  /// before and after.
  std::optional<SE3> motion(std::int64_t earlier_ns, std::int64_t later_ns) const;

 private:
  Trajectory given_;
};

}  // namespace dvi::odometry
