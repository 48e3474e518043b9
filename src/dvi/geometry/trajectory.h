#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "dvi/geometry/se3.h"

namespace dvi {

/// A pose at a time in nanoseconds.
struct StampedPose {
  std::int64_t time_ns = 0;
  SE3 world_from_body;
};

/// Poses in order of time, with interpolation between them.
class Trajectory {
 public:
  Trajectory() = default;
  /// Sorts the poses by time, and keeps the first one of equal times.
  explicit Trajectory(std::vector<StampedPose> poses);

  bool empty() const { return poses_.empty(); }
  const std::vector<StampedPose>& poses() const { return poses_; }

  /// Returns the pose at a time. Outside the span, the first or last motion is continued for at most `max_extrapolation`.
  /// Returns nothing beyond that, or inside a gap longer than `max_gap`.
  std::optional<SE3> at(std::int64_t time_ns) const;

  /// Returns the same motion relative to another world: other_from_world * pose.
  Trajectory in(const SE3& other_from_world) const;

  std::int64_t max_extrapolation = 200'000'000;  ///< ns
  std::int64_t max_gap = 1'000'000'000;          ///< ns

 private:
  std::vector<StampedPose> poses_;
};

}  // namespace dvi
