#pragma once

#include "dvi/synth/street.h"
#include "dvi/synth/synth_options.h"

namespace dvi::synth {

/// How the recording car drives along the street. Places are told as its driver sees them: meters on its way, and meters to the
/// left of the centerline.
class Course {
 public:
  explicit Course(const SynthOptions& options);

  /// Meters on its way after `time` seconds.
  double way(double time) const;
  /// Where it drives, and the other lane of its direction; the same where there is none.
  double lane() const { return lane_; }
  double other_lane() const { return other_lane_; }

  /// (s, d) of the street.
  Eigen::Vector2d place(double way, double left) const;
  /// Where on the way the street's s is.
  double way_at(double s) const { return reverse_ ? begin_ - s : s; }
  SE3 world_from_place(const Street& street, double way, double left, double z, double yaw) const;

 private:
  double speed_mps_ = 0, lane_ = 0, other_lane_ = 0, begin_ = 0;
  int day_ = 1;
  bool reverse_ = false;
};

}  // namespace dvi::synth
