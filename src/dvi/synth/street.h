#pragma once

#include <Eigen/Core>

#include "dvi/geometry/se3.h"

namespace dvi::synth {

/// The cross-section of the street in meters to the left of its centerline. The carriageway is z = 0; the pavements are higher.
inline constexpr double kLeftCurbM = 5.7, kRightCurbM = -9.3, kLeftFacadeM = 9.2, kRightFacadeM = -12.8;
inline constexpr double kPavementHeightM = 0.14;
inline constexpr double kLaneWidthM = 3.5;

/// The centerline: straight along world x from the origin, then an arc, then straight again. A position is (s along it, d to
/// its left).
class Street {
 public:
  Street() = default;
  Street(double arc_begin, double arc_length, double turn_rad);

  Eigen::Vector2d point(double s, double d) const;
  double heading(double s) const;
  /// Returns (s, d) of a point of the world; inverse of point().
  Eigen::Vector2d locate(const Eigen::Vector2d& xy) const;
  /// Returns axes with x along the street rotated by yaw and z up, at a position and height.
  SE3 world_from_place(double s, double d, double z = 0, double yaw = 0) const;

 private:
  double begin_ = 0, length_ = 0, turn_ = 0;
};

}  // namespace dvi::synth
