#include "dvi/synth/course.h"

#include <cmath>
#include <numbers>

namespace dvi::synth {
namespace {

// So far beyond the end of the drive, one that goes the other way begins: both see the same places, from either side.
constexpr double kBeyond = 20;

}  // namespace

Course::Course(const SynthOptions& options)
    : speed_mps_(options.speed_mps), begin_(options.distance() + kBeyond), day_(options.day), reverse_(options.reverse) {
  const double inner = -0.5 * kLane, outer = -1.5 * kLane;
  const bool first = reverse_ || day_ % 2 == 1;  // the other direction has one lane
  lane_ = first ? inner : outer;
  other_lane_ = first && !reverse_ ? outer : inner;
}

double Course::way(double time) const { return speed_mps_ * time + 0.12 * std::sin(0.9 * time + day_); }

Eigen::Vector2d Course::place(double way, double left) const {
  return reverse_ ? Eigen::Vector2d(begin_ - way, -left) : Eigen::Vector2d(way, left);
}

SE3 Course::world_from_place(const Street& street, double way, double left, double z, double yaw) const {
  const Eigen::Vector2d at = place(way, left);
  return street.world_from_place(at.x(), at.y(), z, reverse_ ? yaw + std::numbers::pi : yaw);
}

}  // namespace dvi::synth
