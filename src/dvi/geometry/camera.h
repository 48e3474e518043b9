#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

namespace dvi {

/// The maximum number of pixels of an image.
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

/// A pinhole camera with Brown's distortion (k1, k2, p1, p2, k3) as in OpenCV. Pixel centers are at whole numbers.
struct Camera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 5> distortion{};

  bool is_distorted() const { return distortion != std::array<double, 5>{}; }

  /// Projects a point in camera axes (x right, y down, z forward) to a pixel. Requires z > 0.
  Eigen::Vector2d project(const Eigen::Vector3d& x) const {
    Eigen::Vector2d n(x.x() / x.z(), x.y() / x.z());
    if (is_distorted()) n = distort(n);
    return {fx * n.x() + cx, fy * n.y() + cy};
  }
  /// Returns the point of a pixel at depth z = 1; multiplied by z, it is the point at depth z. Inverse of project().
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;

  /// Returns whether bilinear interpolation at this position stays within the image.
  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width - 1 && pixel.y() <= height - 1;
  }
  /// Returns whether a direction is in front of the camera and within the angle up to which the distortion polynomial
  /// increases. Beyond it, points far outside the image would be projected into it.
  bool in_front(const Eigen::Vector3d& x) const;

 private:
  Eigen::Vector2d distort(const Eigen::Vector2d& n) const;
};

}  // namespace dvi
