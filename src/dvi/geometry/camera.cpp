#include "dvi/geometry/camera.h"

#include <cmath>

namespace dvi {

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& n) const {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

Eigen::Vector3d Camera::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d d((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (!is_distorted()) return {d.x(), d.y(), 1};
  Eigen::Vector2d n = d;
  for (int i = 0; i < 20; ++i) {  // Newton's method
    const Eigen::Vector2d error = distort(n) - d;
    if (error.squaredNorm() < 1e-24) break;
    const double h = 1e-6;
    const Eigen::Vector2d dx = (distort(n + Eigen::Vector2d(h, 0)) - distort(n - Eigen::Vector2d(h, 0))) / (2 * h);
    const Eigen::Vector2d dy = (distort(n + Eigen::Vector2d(0, h)) - distort(n - Eigen::Vector2d(0, h))) / (2 * h);
    const double det = dx.x() * dy.y() - dy.x() * dx.y();
    if (std::abs(det) < 1e-9) break;
    n -= Eigen::Vector2d(dy.y() * error.x() - dy.x() * error.y(), dx.x() * error.y() - dx.y() * error.x()) / det;
  }
  return {n.x(), n.y(), 1};
}

bool Camera::in_front(const Eigen::Vector3d& x) const {
  if (x.z() <= 0.05) return false;
  if (!is_distorted()) return true;
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double r2 = (x.x() * x.x() + x.y() * x.y()) / (x.z() * x.z());
  return 1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3)) > 0;
}

}  // namespace dvi
