#include "dvi/synth/course.h"

#include <cmath>
#include <numbers>

namespace dvi::synth {
namespace {

// A drive in reverse begins this far beyond the end, so that both observe the same places from either side.
constexpr double kReverseMarginM = 20;

}  // namespace

Course::Course(const SynthOptions& options)
    : speed_mps_(options.speed_mps),
      begin_(options.distance() + kReverseMarginM),
      day_(options.day),
      reverse_(options.reverse) {
  const double inner = -0.5 * kLaneWidthM, outer = -1.5 * kLaneWidthM;
  const bool first = reverse_ || day_ % 2 == 1;  // the other direction has only one lane
  lane_ = first ? inner : outer;
  other_lane_ = first && !reverse_ ? outer : inner;
}

double Course::path_length(double time) const { return speed_mps_ * time + 0.12 * std::sin(0.9 * time + day_); }

Eigen::Vector2d Course::place(double length, double left) const {
  return reverse_ ? Eigen::Vector2d(begin_ - length, -left) : Eigen::Vector2d(length, left);
}

SE3 Course::world_from_place(const Street& street, const Eigen::Vector3d& place, double yaw) const {
  const Eigen::Vector2d at = this->place(place.x(), place.y());
  return street.world_from_place(at.x(), at.y(), place.z(), reverse_ ? yaw + std::numbers::pi : yaw);
}

}  // namespace dvi::synth
