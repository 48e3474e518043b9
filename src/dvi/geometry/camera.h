#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace dvi {

/// Images of more pixels are not read.
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

/// A pinhole camera with the distortion of Brown (k1, k2, p1, p2, k3), as OpenCV has it. Pixel centers are whole numbers.
struct Camera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{};

  bool distorted() const { return distortion != std::array<double, 5>{}; }

  /// Pixel of a point in camera axes (x right, y down, z forward). Meaningful for z > 0 only.
  Eigen::Vector2d project(const Eigen::Vector3d& x) const {
    Eigen::Vector2d n(x.x() / x.z(), x.y() / x.z());
    if (distorted()) n = distort(n);
    return {fx * n.x() + cx, fy * n.y() + cy};
  }
  /// The point of that pixel at depth z = 1; times z it is the point at depth z. Inverse of project.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;

  /// Whether bilinear interpolation at this position stays within the image.
  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width - 1 && pixel.y() <= height - 1;
  }
  /// Whether a direction lies where the distortion polynomial still grows with the angle; beyond that, points from
  /// far outside the image fold back into it.
  bool in_front(const Eigen::Vector3d& x) const;

 private:
  Eigen::Vector2d distort(const Eigen::Vector2d& n) const;
};

}  // namespace dvi
