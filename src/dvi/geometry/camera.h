#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

namespace dvi {

/// The maximum number of pixels of an image.
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

/// How a camera projects directions into its image.
enum class CameraModel : std::uint8_t {
  pinhole,          ///< With OpenCV's distortion: Brown's (k1, k2, p1, p2, k3), or the rational one (k4, k5, k6 as well).
  fisheye,          ///< Kannala and Brandt (PAMI 2006), as OpenCV's fisheye module and ROS' `equidistant`: k1, k2, k3, k4.
  unified,          ///< Mei and Rives (ICRA 2007), as OpenCV's omnidir module and KITTI-360: xi, and k1, k2, p1, p2.
  equirectangular,  ///< Longitude along rows and latitude along columns, fx and fy pixels per radian.
  cylindrical,      ///< Longitude along rows, fx pixels per radian; the tangent of the latitude along columns.
};

/// The model's name in settings and results.
std::string to_string(CameraModel model);

/// Returns the model of this name, in any case; the names of OpenCV, ROS, Kalibr, and COLMAP are known as well.
std::optional<CameraModel> find_camera_model(const std::string& name);

/// The model of a camera with its coefficients, in the order of OpenCV, as listed at CameraModel; the others are 0.
struct Lens {
  CameraModel model = CameraModel::pinhole;
  std::array<double, 8> distortion{};
  double xi = 0;  ///< Of the unified model: the distance of the sphere's center from the center of projection.
};

/// Describes why a list of coefficients is not of a model; empty if it is. A pinhole camera has none, 4, 5, or 8, and may have
/// further ones (of a thin prism or a tilted sensor) that are 0; fisheye and unified cameras have none or 4; panoramas none.
std::string describe_lens_problem(CameraModel model, std::span<const double> coefficients);

/// Returns the lens with these coefficients, of which there must be no problem.
Lens make_lens(CameraModel model, std::span<const double> coefficients, double xi = 0);

/// A camera. Pixel centers are at whole numbers; camera axes are x right, y down, z forward. All fields of view below the full
/// sphere are possible: a point is described by its pixel and its depth, which is z of a pinhole camera, and the distance from
/// the camera of all others.
struct Camera {
  int width = 0, height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;
  std::array<double, 8> distortion{};  ///< As Lens::distortion.
  CameraModel model = CameraModel::pinhole;
  double xi = 0;  ///< As Lens::xi.

  void set_lens(const Lens& lens) { model = lens.model, distortion = lens.distortion, xi = lens.xi; }
  bool operator==(const Camera&) const = default;

  /// Returns false only for a pinhole camera without distortion, in whose image straight lines are straight.
  bool is_distorted() const { return model != CameraModel::pinhole || distortion != std::array<double, 8>{}; }
  /// Returns whether an object beside or behind the image plane may be in the image.
  bool is_wide() const { return model != CameraModel::pinhole; }
  /// The coefficients of the distortion: 5 or, if others than those are not 0, 8 of a pinhole camera; 4 of fisheye and unified
  /// cameras; none of panoramas.
  std::span<const double> coefficients() const;

  /// The pixels of a full turn in the image of a panorama: positions that differ by it show the same direction. 0 of others.
  double period_px() const;

  /// Returns the depth of a point in camera axes.
  double depth(const Eigen::Vector3d& x) const { return model == CameraModel::pinhole ? x.z() : x.norm(); }
  /// Projects a point in camera axes to a pixel. Requires in_front(), or z > 0 of a pinhole camera.
  Eigen::Vector2d project(const Eigen::Vector3d& x) const {
    if (is_distorted()) return project_distorted(x);
    return {fx * (x.x() / x.z()) + cx, fy * (x.y() / x.z()) + cy};
  }
  /// Returns the derivative of project() with respect to the point.
  Eigen::Matrix<double, 2, 3> differentiate(const Eigen::Vector3d& x) const;
  /// Returns the point of a pixel at depth 1; multiplied by a depth, it is the point there. Inverse of project(). A pixel that
  /// shows nothing, as the corners of a fisheye image, gets the nearest direction that is visible in about the same direction
  /// from the center.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;

  /// Returns whether bilinear interpolation at this position stays within the image.
  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= width - 1 && pixel.y() <= height - 1;
  }
  /// Returns whether a point has a projection: it is in front of a pinhole camera, and within the angle up to which the
  /// distortion increases. Beyond it, points far outside the image would be projected into it.
  bool in_front(const Eigen::Vector3d& x) const;
  /// Returns whether a direction is projected to the pixel: not in the corners of a fisheye image.
  bool shows(const Eigen::Vector2d& pixel) const;

 private:
  Eigen::Vector2d project_distorted(const Eigen::Vector3d& x) const;
};

}  // namespace dvi
