#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "dvi/testing/test_room.h"

namespace dvi {

/// Returns a smooth random value between -1 and 1 at a point in space.
inline double noise_at(const Eigen::Vector3d& p) {
  const Eigen::Vector3d low = p.array().floor();
  double out = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d offset(corner & 1, corner >> 1 & 1, corner >> 2);
    const Eigen::Vector3d cell = low + offset, distance = (p - cell).cwiseAbs();
    const auto key = static_cast<std::uint64_t>(cell.x() * 73856093 + cell.y() * 19349663 + cell.z() * 83492791 + 1e12);
    Random random(key);
    const Eigen::Array3d weight = 1 - distance.array() * distance.array() * (3 - 2 * distance.array());
    out += random.uniform(-1, 1) * weight.prod();
  }
  return out;
}

/// A recording by a depth camera in a room with textured walls, with exact poses.
struct TestRgbd {
  static constexpr std::int64_t kPeriodNs = 33'333'333;

  std::function<SE3(double)> world_from_lidar;  ///< by time in seconds; x forward, y left, z up
  std::size_t count = 40;
  double color_delay_s = 0;                                             ///< delay of color images relative to depth images
  std::function<double(double)> exposure = [](double) { return 1.0; };  ///< by time in seconds
  std::function<bool(std::size_t)> blank = [](std::size_t) { return false; };  ///< whether an image shows a white wall only
  TestRoom room = make_furnished_room();

  static TestRoom make_furnished_room() {
    TestRoom room;
    room.furnish(3);
    return room;
  }

  Drive drive() const {
    Drive out;
    out.sensor = Sensor::depth_camera;
    out.camera = {.width = 160, .height = 120, .fx = 140, .fy = 140, .cx = 79.5, .cy = 59.5};
    out.camera_from_lidar = {(Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished(), {0, 0, 0}};
    const auto delay = static_cast<std::int64_t>(1e9 * color_delay_s);
    for (std::size_t i = 0; i < count; ++i) {
      const auto time = static_cast<std::int64_t>(i) * kPeriodNs;
      out.scan_headers.push_back({std::to_string(i), time, time, time, {}});
      out.frames.push_back({static_cast<int>(i), std::to_string(i), time + delay, {}, {}});
    }
    const auto self = std::make_shared<const TestRgbd>(*this);
    const Camera camera = out.camera;
    const SE3 lidar_from_camera = out.camera_from_lidar.inverse();
    out.scans = {count, count, [=](std::size_t i) { return self->scan(i, camera, lidar_from_camera); }};
    out.images = {count, count, [=](std::size_t i) { return self->image(i, camera, lidar_from_camera); }};
    return out;
  }

 private:
  double depth_along(const SE3& world_from_camera, const Eigen::Vector3d& ray) const {
    return room.hit(world_from_camera.t, world_from_camera.R * ray);
  }

  Scan scan(std::size_t i, const Camera& camera, const SE3& lidar_from_camera) const {
    const SE3 pose = world_from_lidar(1e-9 * static_cast<double>(kPeriodNs) * static_cast<double>(i)) * lidar_from_camera;
    Random random(i + 1);
    Scan out;
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const Eigen::Vector3d ray = camera.ray({x, y});
        const double depth = blank(i) ? 1.0 : depth_along(pose, ray);
        out.points.push_back((lidar_from_camera * ((depth + 0.0015 * depth * depth * random.normal()) * ray)).cast<float>());
      }
    out.intensity.assign(out.size(), 0.0F);
    out.time.assign(out.size(), 0.0F);
    return out;
  }

  cv::Mat3b image(std::size_t i, const Camera& camera, const SE3& lidar_from_camera) const {
    const double time = 1e-9 * static_cast<double>(kPeriodNs) * static_cast<double>(i) + color_delay_s;
    const SE3 pose = world_from_lidar(time) * lidar_from_camera;
    Random random(1000 + i);
    cv::Mat3b out(camera.height, camera.width);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        double gray = 200;
        if (!blank(i)) {
          const Eigen::Vector3d ray = camera.ray({x, y}), p = pose * (depth_along(pose, ray) * ray);
          gray = exposure(time) * (110 + 50 * noise_at(5 * p) + 40 * noise_at(13 * p));
        }
        const auto value = static_cast<uchar>(std::clamp(std::lround(gray + 2 * random.normal()), 0L, 255L));
        out(y, x) = {value, value, value};
      }
    return out;
  }
};

}  // namespace dvi
