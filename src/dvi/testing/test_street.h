#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "dvi/core/random.h"
#include "dvi/drive/drive.h"

namespace dvi {

/// A street of boxes for tests, scanned by a LiDAR with exactly known motion.
class TestStreet {
 public:
  int beams = 32, columns = 720;
  double noise_m = 0.01;
  bool rings = true;  ///< whether scans have the ring of each point
  std::vector<Eigen::AlignedBox3d> boxes;

  /// Adds ground, facades at several distances from the road, and poles in front of them.
  TestStreet() {
    add({-500, -500, -1}, {500, 500, 0});
    Random random(5);
    for (const double side : {-1.0, 1.0})
      for (double x = -60; x < 120; x += 12) {
        const double back = side * random.uniform(9, 14);
        add({x, std::min(back, 20 * side), 0}, {x + 9, std::max(back, 20 * side), random.uniform(5, 9)});
        const double at = x + random.uniform(0, 12);
        add({at, 6 * side - 0.1, 0}, {at + 0.2, 6 * side + 0.1, 5});
      }
  }

  /// Makes a street of ground and two long walls only.
  static TestStreet tunnel() {
    TestStreet street;
    street.boxes.clear();
    street.add({-5000, -500, -1}, {5000, 500, 0});
    street.add({-5000, 5, 0}, {5000, 8, 9});
    street.add({-5000, -8, 0}, {5000, -5, 9});
    return street;
  }

  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { boxes.emplace_back(a, b); }

  /// Makes the scan around `time_s`, which rotates clockwise from behind, with the sensor's pose at the time of each firing.
  Scan scan(const Trajectory& world_from_lidar, double time_s, double scan_s = 0.1) const {
    Random random(static_cast<std::uint64_t>(1e3 * (time_s + 100)));
    Scan out;
    for (int c = 0; c < columns; ++c) {
      const double fraction = (c + 0.5) / columns, t = scan_s * (fraction - 0.5);
      const SE3 pose = *world_from_lidar.at(std::llround(1e9 * (time_s + t)));
      for (int b = 0; b < beams; ++b) {
        const double azimuth = std::numbers::pi * (1 - 2 * fraction);
        const double elevation = (-24.8 + 26.8 * b / (beams - 1)) * std::numbers::pi / 180;
        const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                  std::sin(elevation));
        const double range = hit(pose.t, pose.R * ray);
        if (range > 80) continue;
        out.points.push_back(((range + noise_m * random.normal()) * ray).cast<float>());
        out.intensity.push_back(0);
        out.time.push_back(static_cast<float>(t));
        if (rings) out.ring.push_back(static_cast<std::uint16_t>(b));
      }
    }
    return out;
  }

  /// Makes a drive of `count` scans, 0.1 s apart, of a car that follows `path`.
  Drive drive(const Trajectory& path, int count) const {
    Drive out;
    for (int i = 0; i < count; ++i) {
      const std::int64_t t = i * kScanPeriodNs;
      out.scan_headers.push_back({std::to_string(i), t, t - kScanPeriodNs / 2, t + kScanPeriodNs / 2, {}});
    }
    out.scans = {out.scan_headers.size(), out.scan_headers.size(),
                 [street = *this, path](std::size_t i) { return street.scan(path, 0.1 * static_cast<double>(i)); }};
    return out;
  }

  /// Makes a path that begins 1.8 m above the ground along x, and turns left at `turn` rad/s; `speed` in m/s grows by `push`
  /// m/s^2.
  static Trajectory path(double speed, double turn = 0, double push = 0) {
    std::vector<StampedPose> poses;
    SE3 pose;
    pose.t = {-3, 0, 1.8};
    for (int i = -10; i < 400; ++i) {
      poses.push_back({i * kScanPeriodNs / 10, pose});
      Vector6d step = Vector6d::Zero();
      step[0] = 0.01 * (speed + push * 0.01 * std::max(i, 0));
      step[5] = 0.01 * turn;
      pose = pose * se3_exp(step);
    }
    return Trajectory(poses);
  }

  static constexpr std::int64_t kScanPeriodNs = 100'000'000;

 private:
  double hit(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::AlignedBox3d& box : boxes) {
      const Eigen::Array3d a = (box.min() - from).array() / ray.array(), b = (box.max() - from).array() / ray.array();
      const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
      if (in > 0 && in <= out) nearest = std::min(nearest, in);
    }
    return nearest;
  }
};

/// Returns the largest position error of a trajectory in meters.
inline double worst_error(const Trajectory& found, const Trajectory& path) {
  double worst = 0;
  for (const StampedPose& p : found.poses())
    worst = std::max(worst, (p.world_from_body.t - (path.at(0)->inverse() * *path.at(p.time_ns)).t).norm());
  return worst;
}

}  // namespace dvi
