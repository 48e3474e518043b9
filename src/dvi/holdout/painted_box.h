#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/geometry/box.h"
#include "dvi/geometry/camera.h"

namespace dvi::holdout {

/// The first intersection of a ray with a box.
struct BoxHit {
  double distance = 0;     ///< in units of the length of `direction`
  int axis = 0, side = 0;  ///< of the face: axis 0 to 2, side -1 or 1
  Eigen::Vector3d point;   ///< in the axes of the box
};

/// Finds the first intersection; nothing if the ray misses the box, points away from it, or starts inside it.
std::optional<BoxHit> find_hit(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// The colors of an image, and the pixels (255) that have a color.
struct Painting {
  cv::Mat3b colors;
  cv::Mat1b pixels;
};

/// Paints the box in the view of the camera. Each face has its own shade with noise; colors depend on the seed alone. A pixel
/// is painted if the ray of its center hits the box.
Painting paint_box(const Box& camera_box, const Camera& camera, std::uint64_t seed);

/// Paints a rectangle of noise; its position depends on the seed.
Painting paint_banner(cv::Size image, std::uint64_t seed);

/// Returns the color of the margin around a painted object.
cv::Vec3b get_outline_color(std::uint64_t seed);

}  // namespace dvi::holdout
