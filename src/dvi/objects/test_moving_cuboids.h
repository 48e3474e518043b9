#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>

#include "dvi/core/random.h"
#include "dvi/objects/test_plain_drive.h"

namespace dvi::objects {

// For tests only.

using Cuboid = Eigen::AlignedBox3d;  ///< world axes; the ground is z = 0

inline Cuboid car_at(double x, double y) { return {Eigen::Vector3d(x, y, 0.2), Eigen::Vector3d(x + 4, y + 1.8, 1.5)}; }
inline Cuboid person_at(double x, double y) { return {Eigen::Vector3d(x, y, 0), Eigen::Vector3d(x + 0.5, y + 0.6, 1.8)}; }

/// A street between houses, with a parked car, scanned by a LiDAR that drives along x. Entries of `movers` may move. The camera
/// of the drive is at the LiDAR and looks along x; frame i is taken with scan i.
struct Situation {
  int scans = 0;
  std::function<double(int)> sensor_x = [](int) { return 0.0; };
  std::function<std::vector<Cuboid>(int)> movers;
  double degrees_between_beams = 0.4;
  double yaw_error_deg = 0;  ///< random error of each pose

  static std::vector<Cuboid> houses() {
    std::vector<Cuboid> out{{Eigen::Vector3d(70, -40, 0), Eigen::Vector3d(72, 40, 9)}};
    for (int i = -2; i < 7; ++i)
      for (const double y : {-14.0, 8.0})
        out.emplace_back(Eigen::Vector3d(10 * i, y, 0), Eigen::Vector3d(10 * i + 7, y + 6, 9));
    return out;
  }
  static Cuboid parked() { return car_at(14, -5.5); }

  SE3 pose(int scan) const { return {Eigen::Matrix3d::Identity(), {sensor_x(scan), 0, 1.7}}; }

  /// Returns all surfaces at the time of a scan except the ground.
  std::vector<Cuboid> surfaces(int scan) const {
    std::vector<Cuboid> out = houses();
    out.push_back(parked());
    for (const Cuboid& mover : movers(scan)) out.push_back(mover);
    return out;
  }

  Scan measure(std::size_t i) const {
    constexpr double kDegree = std::numbers::pi / 180;
    const std::vector<Cuboid> all = surfaces(static_cast<int>(i));
    const Eigen::Vector3d sensor = pose(static_cast<int>(i)).t;
    Random random(i + 1);
    Scan scan;
    for (double up = -20; up <= 3; up += degrees_between_beams)
      for (double aside = -180; aside < 180; aside += 0.5) {
        const Eigen::Vector3d ray(std::cos(aside * kDegree) * std::cos(up * kDegree),
                                  std::sin(aside * kDegree) * std::cos(up * kDegree), std::sin(up * kDegree));
        const double length = measure_range(all, sensor, ray);
        if (length > 90) continue;
        scan.points.emplace_back(((length + 0.02 * random.normal()) * ray).cast<float>());
        scan.time.push_back(0);
        scan.intensity.push_back(0.5F);
      }
    return scan;
  }

  Drive drive() const {
    Drive out = PlainDrive(scans, 0).drive;
    std::vector<StampedPose> poses;
    Random random(7);
    for (int i = 0; i < scans; ++i) {
      SE3 at = pose(i);
      at.R = Eigen::AngleAxisd(yaw_error_deg * random.normal() * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()).matrix();
      poses.push_back({i * PlainDrive::kScanPeriodNs, at});
    }
    out.poses = Trajectory(poses);
    out.scans = Lazy<Scan>(static_cast<std::size_t>(scans), static_cast<std::size_t>(scans),
                           [self = *this](std::size_t i) { return self.measure(i); });
    return out;
  }

  /// Draws the pixels of a frame that show one of the objects, which are among the surfaces at that time.
  cv::Mat1b draw_mask(int frame, const std::vector<Cuboid>& objects) const {
    const Camera camera = PlainDrive(1, 0).drive.camera;
    const Eigen::Vector3d sensor = pose(frame).t;
    const std::vector<Cuboid> all = surfaces(frame);
    cv::Mat1b mask(camera.height, camera.width, uchar{0});
    for (int y = 0; y < mask.rows; ++y)
      for (int x = 0; x < mask.cols; ++x) {
        const Eigen::Vector3d in_camera = camera.ray({x, y}), ray(in_camera.z(), -in_camera.x(), -in_camera.y());
        double object = 1e9;
        for (const Cuboid& cuboid : objects) object = std::min(object, intersect(cuboid, sensor, ray));
        if (object < 1e9 && object <= measure_range(all, sensor, ray)) mask(y, x) = 255;
      }
    return mask;
  }

 private:
  static double intersect(const Cuboid& cuboid, const Eigen::Vector3d& sensor, const Eigen::Vector3d& ray) {
    const Eigen::Array3d a = (cuboid.min() - sensor).array() / ray.array(), b = (cuboid.max() - sensor).array() / ray.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    return enter > 0 && enter < leave ? enter : 1e9;
  }

  // Returns the length of a ray in multiples of its vector.
  static double measure_range(const std::vector<Cuboid>& surfaces, const Eigen::Vector3d& sensor, const Eigen::Vector3d& ray) {
    double length = ray.z() < 0 ? -sensor.z() / ray.z() : 1e9;
    for (const Cuboid& surface : surfaces) length = std::min(length, intersect(surface, sensor, ray));
    return length;
  }
};

}  // namespace dvi::objects
