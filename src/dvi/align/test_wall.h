#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "dvi/align/align.h"
#include "dvi/core/random.h"
#include "dvi/geometry/angles.h"
#include "dvi/image/interpolate.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::align {

/// The errors of the poses of a ShakyDrive, and its motion.
struct PoseError {
  double jitter_deg = 0;                               ///< largest pitch and yaw of a frame
  Eigen::Vector3d mounting = Eigen::Vector3d::Zero();  ///< radians, the same in all frames
  Eigen::Vector3d speed{1, 0, 0};                      ///< meters per second, camera axes
  cv::Rect hole{140, 100, 40, 40};
  double gain_step = 1;  ///< of brightness from frame to frame
};

/// A drive for tests: a textured wall 12 m ahead of the first view, with errors in the poses.
struct ShakyDrive {
  map::StaticMap map;
  Views views;
  std::vector<Eigen::Vector3d> errors;  ///< radians: the rotation that each pose lacks

  ShakyDrive(std::size_t count, const PoseError& shake, const Camera& camera = {320, 240, 400, 400, 159.5, 119.5, {}}) {
    constexpr double kDepthM = 12, kPixelsPerMeter = 40;
    static const cv::Mat3b texture = waves(1000, 600, 7, 5);
    for (double x = -10; x <= 10; x += 0.05)
      for (double y = -6; y <= 6; y += 0.1) map.points.push_back({Eigen::Vector3d(x, y, kDepthM).cast<float>(), 0, 1});
    map.tiles = {{Eigen::AlignedBox3f(Eigen::Vector3f(-10, -6, 12), Eigen::Vector3f(10, 6, 12)), 0, map.points.size()}};
    Random random(3);
    std::vector<View> list;
    std::vector<cv::Mat3b> images;
    std::vector<cv::Mat1b> masks;
    for (std::size_t i = 0; i < count; ++i) {
      View view;
      view.frame = i;
      view.time_ns = static_cast<std::int64_t>(i) * 100'000'000;
      view.camera = camera;
      view.camera_from_world.t = -0.1 * static_cast<double>(i) * shake.speed;
      const double limit = to_radians(shake.jitter_deg), gain = std::pow(shake.gain_step, static_cast<double>(i));
      const double pitch = random.uniform(-limit, limit), yaw = random.uniform(-limit, limit);
      errors.emplace_back(shake.mounting + Eigen::Vector3d(pitch, yaw, 0));
      const SE3 truth = SE3{so3_exp(errors.back()), {0, 0, 0}} * view.camera_from_world;
      const SE3 world_from_camera = truth.inverse();
      cv::Mat3b image(camera.height, camera.width);
      for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
          const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray({x, y});
          const Eigen::Vector3d p = world_from_camera.t + (kDepthM - world_from_camera.t.z()) / ray.z() * ray;
          const cv::Vec3f c = bilinear(
              texture, {static_cast<float>(500 + kPixelsPerMeter * p.x()), static_cast<float>(300 + kPixelsPerMeter * p.y())});
          for (int k = 0; k < 3; ++k) image(y, x)[k] = cv::saturate_cast<uchar>(gain * c[k]);
        }
      cv::Mat1b mask(image.size(), uchar{0});
      mask(shake.hole) = 255;
      image(shake.hole) = cv::Vec3b(0, 0, 255);
      list.push_back(view);
      images.push_back(image);
      masks.push_back(mask);
    }
    views = memory_views(list, images, masks);
  }

  /// Returns the RMS of the remaining errors in pitch and yaw in degrees, without the part common to all frames, which is
  /// hardly observable on a flat wall.
  double residual_deg(const std::vector<ViewAlignment>& found) const {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < errors.size(); ++i)
      mean += (errors[i] - found[i].rotation) / static_cast<double>(errors.size());
    double sum = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) sum += (errors[i] - found[i].rotation - mean).head<2>().squaredNorm();
    return to_degrees(std::sqrt(sum / static_cast<double>(2 * errors.size())));
  }
};

}  // namespace dvi::align
