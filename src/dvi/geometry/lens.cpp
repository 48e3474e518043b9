#include "dvi/geometry/lens.h"

#include <algorithm>
#include <cmath>

namespace dvi {
namespace {

constexpr int kMaxIterations = 20;
constexpr int kSteps = 8;  // positions between the center and a point at which a distortion is checked to increase

}  // namespace

PlaneDistortion::Radial PlaneDistortion::radial(double r2) const {
  const double k1 = k_[0], k2 = k_[1], k3 = k_[4];
  const double above = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), above_slope = k1 + r2 * (2 * k2 + r2 * 3 * k3);
  if (!is_rational()) return {above, above_slope};
  const double k4 = k_[5], k5 = k_[6], k6 = k_[7];
  const double below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6)), below_slope = k4 + r2 * (2 * k5 + r2 * 3 * k6);
  return {above / below, (above_slope * below - above * below_slope) / (below * below)};
}

Eigen::Vector2d PlaneDistortion::distort(const Eigen::Vector2d& n) const {
  const double p1 = k_[2], p2 = k_[3], x = n.x(), y = n.y(), r2 = x * x + y * y, factor = radial(r2).factor;
  return {x * factor + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * factor + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Matrix2d PlaneDistortion::differentiate(const Eigen::Vector2d& n) const {
  const double p1 = k_[2], p2 = k_[3], x = n.x(), y = n.y();
  const Radial at = radial(x * x + y * y);
  const double slope = 2 * at.slope, mixed = x * y * slope + 2 * p1 * x + 2 * p2 * y;
  Eigen::Matrix2d out;
  out << at.factor + x * x * slope + 2 * p1 * y + 6 * p2 * x, mixed, mixed, at.factor + y * y * slope + 6 * p1 * y + 2 * p2 * x;
  return out;
}

Eigen::Vector2d PlaneDistortion::undistort(const Eigen::Vector2d& d) const {
  Eigen::Vector2d n = d;
  for (int i = 0; i < kMaxIterations; ++i) {  // Newton's method
    const Eigen::Vector2d error = distort(n) - d;
    if (error.squaredNorm() < 1e-24) break;
    const Eigen::Matrix2d J = differentiate(n);
    if (std::abs(J.determinant()) < 1e-9) break;
    n -= J.inverse() * error;
  }
  return n.allFinite() ? n : d;
}

bool PlaneDistortion::increases_to(double r2) const {
  const auto increases_at = [&](double s2) {
    const Radial at = radial(s2);
    return at.factor + 2 * s2 * at.slope > 0;
  };
  if (!is_rational()) return increases_at(r2);
  for (int i = 1; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps, s2 = share * share * r2;
    const double below = 1 + s2 * (k_[5] + s2 * (k_[6] + s2 * k_[7]));
    if (!(below > 0) || !increases_at(s2)) return false;
  }
  return true;
}

double AngleDistortion::radius(double angle) const {
  const double t2 = angle * angle;
  return angle * (1 + t2 * (k_[0] + t2 * (k_[1] + t2 * (k_[2] + t2 * k_[3]))));
}

double AngleDistortion::slope(double angle) const {
  const double t2 = angle * angle;
  return 1 + t2 * (3 * k_[0] + t2 * (5 * k_[1] + t2 * (7 * k_[2] + t2 * 9 * k_[3])));
}

double AngleDistortion::angle(double radius) const {
  // Newton's method within the interval in which the radius is known to increase, and bisection where it would leave it.
  double low = 0, high = kMaxAngle;
  constexpr int kIntervals = 64;
  for (int i = 1; i <= kIntervals; ++i) {
    const double next = kMaxAngle * i / kIntervals;
    if (slope(next) <= 0 || this->radius(next) >= radius) {
      high = next;
      break;
    }
    low = next;
  }
  double at = low;
  for (int i = 0; i < 2 * kMaxIterations; ++i) {
    const double error = this->radius(at) - radius, steep = slope(at);
    if (std::abs(error) < 1e-13) break;
    (error < 0 && steep > 0 ? low : high) = at;
    const double step = steep > 0 ? at - error / steep : high;
    at = step > low && step < high ? step : 0.5 * (low + high);
  }
  return at;
}

bool AngleDistortion::increases_to(double angle) const {
  if (angle > kMaxAngle) return false;
  for (int i = 1; i <= kSteps; ++i)
    if (slope(angle * i / kSteps) <= 0) return false;
  return true;
}

}  // namespace dvi
