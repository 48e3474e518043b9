#pragma once

#include "dvi/synth/street.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// The course of the recording car along the street. Positions are in its driving direction: path length in meters, and meters
/// to the left of the centerline.
class Course {
 public:
  explicit Course(const SynthOptions& options);

  /// Returns the path length in meters after `time` seconds.
  double path_length(double time) const;
  /// Return the lateral position of its lane and of the other lane of its direction; both are the same if there is only one
  /// lane.
  double lane() const { return lane_; }
  double other_lane() const { return other_lane_; }

  /// Converts a position to (s, d) of the street.
  Eigen::Vector2d place(double length, double left) const;
  /// Returns the path length at the street's s.
  double path_length_at(double s) const { return reverse_ ? begin_ - s : s; }
  /// Returns the pose at a place: path length, meters to the left, and height.
  SE3 world_from_place(const Street& street, const Eigen::Vector3d& place, double yaw) const;

 private:
  double speed_mps_ = 0, lane_ = 0, other_lane_ = 0, begin_ = 0;
  int day_ = 1;
  bool reverse_ = false;
};

}  // namespace dvi::synth
