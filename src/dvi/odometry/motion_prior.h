#pragma once

#include <optional>

#include "dvi/geometry/trajectory.h"

namespace dvi::odometry {

/// How given poses say that the LiDAR moved between two sweeps. They are held against themselves here, against the scans where
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
