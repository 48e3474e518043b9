#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "dvi/core/random.h"
#include "dvi/drive/drive.h"

namespace dvi::objects {

// For tests only.

/// A drive along x over a plain of a given slope. The LiDAR scans rings on the plain, and the camera looks along x.
/// Its images are gray.
struct PlainDrive {
  static constexpr std::int64_t kScanPeriodNs = 100'000'000;

  Drive drive;

  explicit PlainDrive(int scans, double slope, double outliers = 0) {
    drive.camera = {320, 192, 240, 240, 159.5, 80.5, {}};
    drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    std::vector<StampedPose> poses;
    for (int i = 0; i < scans; ++i) {
      const double x = 0.8 * i;
      poses.push_back({i * kScanPeriodNs, {Eigen::Matrix3d::Identity(), {x, 0, slope * x + 1.7}}});
      drive.scan_headers.push_back({"", i * kScanPeriodNs, i * kScanPeriodNs, i * kScanPeriodNs, {}});
      drive.frames.push_back({i, std::to_string(i), i * kScanPeriodNs, {}, {}});
    }
    drive.poses = Trajectory(poses);
    const cv::Size size(drive.camera.width, drive.camera.height);
    drive.images = Lazy<cv::Mat3b>(scans, 4, [size](std::size_t) { return cv::Mat3b(size, cv::Vec3b::all(128)); });
    drive.scans = Lazy<Scan>(scans, 4, [slope, outliers](std::size_t i) {
      Scan scan;
      Random random(i + 1);
      for (double range = 2; range < 45; range += 0.4)
        for (int a = 0; a < 360; a += 2) {
          const double angle = a * std::numbers::pi / 180, x = range * std::cos(angle), y = range * std::sin(angle);
          const double below = random.uniform(0, 1) < outliers ? -1.5 : 0;
          scan.points.emplace_back(x, y, slope * x - 1.7 + below + 0.02 * random.normal());
          scan.time.push_back(0);
        }
      return scan;
    });
  }
};

/// Returns the gray level of the plain.
inline float sample_road(const Eigen::Vector2d& x) {
  return static_cast<float>(120 + 25 * std::sin(0.9 * x.x()) + 25 * std::sin(1.3 * x.y()));
}

}  // namespace dvi::objects
