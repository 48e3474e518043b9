#pragma once

#include <Eigen/Core>

#include "dvi/geometry/se3.h"

namespace dvi::synth {

/// The cross-section of the street, in meters left of its centerline. The ground is z = 0, the pavements lie higher.
inline constexpr double kLeftCurb = 5.7, kRightCurb = -9.3, kLeftFacade = 9.2, kRightFacade = -12.8;
inline constexpr double kPavementHeight = 0.14;
inline constexpr double kLane = 3.5;

/// The centerline: straight along world x from the origin, an arc, straight again. A place is (s along it, d to its left).
class Street {
 public:
  Street() = default;
  Street(double arc_begin, double arc_length, double turn_rad);

  Eigen::Vector2d point(double s, double d) const;
  double heading(double s) const;
  /// (s, d) of a point of the world; inverse of `point`.
  Eigen::Vector2d locate(const Eigen::Vector2d& xy) const;
  /// x along the street turned by yaw, z up, at a place and height.
  SE3 world_from_place(double s, double d, double z = 0, double yaw = 0) const;

 private:
  double begin_ = 0, length_ = 0, turn_ = 0;
};

}  // namespace dvi::synth
