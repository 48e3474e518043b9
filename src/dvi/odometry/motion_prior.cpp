#include "dvi/odometry/motion_prior.h"

#include <cmath>
#include <vector>

#include "dvi/core/median.h"

namespace dvi::odometry {

std::optional<SE3> MotionPrior::motion(std::int64_t earlier_ns, std::int64_t later_ns) const {
  const std::int64_t span = later_ns - earlier_ns;
  const auto step = [&](int k) -> std::optional<SE3> {
    const std::optional<SE3> a = given_.at(earlier_ns + k * span), b = given_.at(later_ns + k * span);
    if (!a || !b) return std::nullopt;
    return a->inverse() * *b;
  };
  const std::optional<SE3> here = step(0);
  if (!here) return std::nullopt;
  std::vector<Vector6d> around;
  for (int k = -kMotionPrior.neighbors; k <= kMotionPrior.neighbors; ++k)
    if (const std::optional<SE3> other = step(k)) around.push_back(se3_log(*other));
  if (around.size() < kMotionPrior.min_intervals) return std::nullopt;
  const double seconds = 1e-9 * static_cast<double>(span);
  const Vector6d twist = se3_log(*here);
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> values;
    for (const Vector6d& other : around) values.push_back(other[axis]);
    if (std::abs(twist[axis] - median(values)) >
        (axis < 3 ? kMotionPrior.max_speed_change_m_s : kMotionPrior.max_turn_change_rad_s) * seconds)
      return std::nullopt;
  }
  return here;
}

}  // namespace dvi::odometry
