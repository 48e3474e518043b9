#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"

namespace dvi::odometry {

/// A pinhole camera without distortion.
struct Pinhole {
  float fx = 1, fy = 1, cx = 0, cy = 0;

  Eigen::Vector2f project(const Eigen::Vector3f& x) const { return {fx * x.x() / x.z() + cx, fy * x.y() / x.z() + cy}; }
  /// Returns the point of a pixel at depth 1.
  Eigen::Vector3f ray(int x, int y) const { return {(static_cast<float>(x) - cx) / fx, (static_cast<float>(y) - cy) / fy, 1}; }
};

inline double to_seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// One level of the pyramid of an RgbdImage.
struct RgbdLevel {
  Pinhole camera;
  cv::Mat1f gray;  ///< gray levels; empty if the moment has no color image
  /// The mean of the points that a pixel shows, in camera axes, in meters; z is 0 where the depth is unknown.
  cv::Mat3f points;

  Eigen::Vector3f point(int y, int x) const {
    const cv::Vec3f& p = points(y, x);
    return {p[0], p[1], p[2]};
  }
};

/// Color and depth of one moment from the view of one camera, from fine (about 320 pixels wide) to coarse (about 40).
struct RgbdImage {
  std::vector<RgbdLevel> levels;

  bool has_gray() const { return !levels.empty() && !levels.front().gray.empty(); }
};

/// A depth image and the color image that was taken at nearly the same time, as indices into the drive.
struct RgbdMoment {
  std::size_t scan_index = 0;
  std::optional<std::size_t> frame;  ///< none if no color image belongs to the depth image
  std::int64_t time_ns = 0;          ///< of the color image, or of the depth image if there is none
  double depth_delay_s = 0;          ///< time of the depth image less `time_ns`
};

/// Depth is not corrected for the motion of the camera if its delay is at most this: no point would be displaced by a pixel.
inline constexpr double kMinDelayS = 1e-3;

/// Pairs each depth image with the nearest color image. A color image belongs to at most one depth image; the delay is at most
/// 25 ms.
std::vector<RgbdMoment> pair_depth_with_color(const Drive& drive);

/// Returns the camera of the finest level.
Pinhole get_finest_camera(const Camera& camera);

/// Reads the images of a moment. `twist` is the motion of the color camera (meters and radians per second, in its own axes)
/// by which the depth is moved to the time of the color image: at 2 rad/s, 15 ms are 1.7 degrees. Distortion is removed.
RgbdImage read_rgbd_image(const Drive& drive, const RgbdMoment& moment, const Vector6d& twist);

/// Computes the normals of the surfaces at the points of a level; a normal is zero where it is unknown. `stride` is the
/// distance in pixels of the neighbors that a normal is computed from.
cv::Mat3f compute_normals(const RgbdLevel& level, int stride);

}  // namespace dvi::odometry
