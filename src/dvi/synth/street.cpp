#include "dvi/synth/street.h"

#include <algorithm>
#include <cmath>

namespace dvi::synth {

Street::Street(double arc_begin, double arc_length, double turn_rad)
    : begin_(arc_begin), length_(arc_length), turn_(turn_rad) {}

double Street::heading(double s) const { return turn_ == 0 ? 0 : turn_ * std::clamp((s - begin_) / length_, 0.0, 1.0); }

Eigen::Vector2d Street::point(double s, double d) const {
  if (turn_ == 0) return {s, d};
  const double radius = length_ / turn_, angle = heading(s);
  const double before = std::min(s - begin_, 0.0), after = std::max(s - begin_ - length_, 0.0);
  const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), left(-along.y(), along.x());
  const Eigen::Vector2d arc(begin_ + radius * along.y(), radius * (1 - along.x()));
  return arc + along * (before + after) + left * d;
}

Eigen::Vector2d Street::locate(const Eigen::Vector2d& xy) const {
  if (turn_ == 0) return xy;
  const Eigen::Vector2d end = point(begin_ + length_, 0), along(std::cos(turn_), std::sin(turn_));
  const Eigen::Vector2d rest = xy - end, second(along.dot(rest), along.x() * rest.y() - along.y() * rest.x());
  const bool in_first = xy.x() <= begin_, in_second = second.x() >= 0;
  if (in_first && !(in_second && std::abs(second.y()) < std::abs(xy.y()))) return xy;
  if (in_second) return {begin_ + length_ + second.x(), second.y()};
  const double radius = length_ / turn_, sign = std::copysign(1.0, turn_);
  const Eigen::Vector2d from_center = xy - Eigen::Vector2d(begin_, radius);
  const double angle = std::atan2(from_center.x(), -sign * from_center.y());
  return {begin_ + angle * std::abs(radius), radius - sign * from_center.norm()};
}

SE3 Street::world_from_place(double s, double d, double z, double yaw) const {
  const Eigen::Vector2d at = point(s, d);
  return {so3_exp({0, 0, heading(s) + yaw}), {at.x(), at.y(), z}};
}

}  // namespace dvi::synth
