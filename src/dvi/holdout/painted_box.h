#pragma once

#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

#include "dvi/geometry/box.h"
#include "dvi/geometry/camera.h"

namespace dvi::holdout {

/// Where a ray first meets a box.
struct BoxHit {
  double distance = 0;     ///< in lengths of `direction`
  int axis = 0, side = 0;  ///< of the face: axis 0 to 2, side -1 or 1
  Eigen::Vector3d point;   ///< in the box's axes
};

/// Exact; none where the ray misses the box, leaves it behind or starts inside it.
std::optional<BoxHit> first_hit(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Colors of an image, and the pixels (255) that have some.
struct Painting {
  cv::Mat3b colors;
  cv::Mat1b pixels;
};

/// The box as the camera sees it: each face of a shade of its own with a grain of noise, by the seed alone. A pixel is painted
/// if the ray of its center meets the box.
Painting paint_box(const Box& camera_box, const Camera& camera, std::uint64_t seed);

/// A rectangle of noise whose place varies by the seed.
Painting paint_banner(cv::Size image, std::uint64_t seed);

/// What stands for the edge of anything painted.
cv::Vec3b outline_color(std::uint64_t seed);

}  // namespace dvi::holdout
