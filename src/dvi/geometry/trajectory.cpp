#include "dvi/geometry/trajectory.h"

#include <algorithm>

namespace dvi {

Trajectory::Trajectory(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  std::stable_sort(poses_.begin(), poses_.end(), [](const auto& a, const auto& b) { return a.time_ns < b.time_ns; });
  const auto same = [](const auto& a, const auto& b) { return a.time_ns == b.time_ns; };
  poses_.erase(std::unique(poses_.begin(), poses_.end(), same), poses_.end());
}

std::optional<SE3> Trajectory::at(std::int64_t time_ns) const {
  if (poses_.empty()) return std::nullopt;
  if (time_ns < poses_.front().time_ns - max_extrapolation || time_ns > poses_.back().time_ns + max_extrapolation)
    return std::nullopt;
  const auto after = std::lower_bound(poses_.begin(), poses_.end(), time_ns,
                                      [](const StampedPose& p, std::int64_t t) { return p.time_ns < t; });
  if (after != poses_.end() && after->time_ns == time_ns) return after->world_from_body;
  if (poses_.size() == 1) return std::nullopt;
  const auto b = std::clamp(after, poses_.begin() + 1, poses_.end() - 1);
  const auto a = b - 1;
  if (b->time_ns - a->time_ns > max_gap) return std::nullopt;
  const double u = static_cast<double>(time_ns - a->time_ns) / static_cast<double>(b->time_ns - a->time_ns);
  return interpolate(a->world_from_body, b->world_from_body, u);
}

Trajectory Trajectory::in(const SE3& other_from_world) const {
  Trajectory other = *this;
  for (StampedPose& p : other.poses_) p.world_from_body = other_from_world * p.world_from_body;
  return other;
}

}  // namespace dvi
