#include "dvi/odometry/motion_prior.h"

#include <cmath>
#include <vector>

#include "dvi/core/median.h"

namespace dvi::odometry {
namespace {

constexpr int kAround = 2;               // stretches looked at before and after
constexpr std::size_t kFewestSteps = 3;  // of all five, to tell a jump by
constexpr double kSpeedJump = 1.5,
                 kTurnJump = 0.25;  // meters and radians a second: more than braking and turning in do in 0.2 s

}  // namespace

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
  for (int k = -kAround; k <= kAround; ++k)
    if (const std::optional<SE3> other = step(k)) around.push_back(se3_log(*other));
  if (around.size() < kFewestSteps) return std::nullopt;
  const double seconds = 1e-9 * static_cast<double>(span);
  const Vector6d twist = se3_log(*here);
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> values;
    for (const Vector6d& other : around) values.push_back(other[axis]);
    if (std::abs(twist[axis] - median(values)) > (axis < 3 ? kSpeedJump : kTurnJump) * seconds) return std::nullopt;
  }
  return here;
}

}  // namespace dvi::odometry
