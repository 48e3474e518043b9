#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/odometry/odometry.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::odometry {

using namespace scan_match;

namespace {

constexpr std::int64_t kPeriod = 33'333'333;

// Walls, floor and a table, seen by a depth camera of 60 x 45 degrees whose noise grows with the square of the depth.
class Room {
 public:
  Scan scan(const SE3& world_from_camera, std::uint64_t seed) const {
    Random random(seed);
    Scan out;
    for (int v = -45; v <= 45; ++v)
      for (int u = -60; u <= 60; ++u) {
        const Eigen::Vector3d ray(1, 0.01 * u, 0.0092 * v);
        const double depth = hit(world_from_camera.t, world_from_camera.R * ray);
        out.points.push_back(((depth + 0.002 * depth * depth * random.normal()) * ray).cast<float>());
      }
    out.intensity.assign(out.size(), 0.0F);
    out.time.assign(out.size(), 0.0F);
    return out;
  }

 private:
  // In lengths of the ray.
  static double hit(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
    double nearest = 100;
    const Eigen::Array3d low(-1, -2, 0), high(3, 1.5, 2.5);
    for (int axis = 0; axis < 3; ++axis)
      if (ray[axis] != 0) nearest = std::min(nearest, ((ray[axis] > 0 ? high : low)[axis] - from[axis]) / ray[axis]);
    const Eigen::Array3d a = (Eigen::Array3d(1.4, -0.5, 0) - from.array()) / ray.array();
    const Eigen::Array3d b = (Eigen::Array3d(2.2, 0.4, 0.8) - from.array()) / ray.array();
    const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
    return in > 0 && in <= out ? std::min(nearest, in) : nearest;
  }
};

// A hand that goes sideways, nods and turns.
SE3 hand(int i) {
  const double s = 0.05 * i;
  return {so3_exp({0.03 * std::sin(s), 0.4 + 0.1 * std::sin(1.3 * s), 0.3 * std::sin(s)}), {0.1 * s, 0.4 * std::sin(s), 1.4}};
}

TEST(Odometry, FollowsADepthCameraThroughARoom) {
  Drive drive;
  drive.sensor = Sensor::depth_camera;
  for (int i = 0; i < 40; ++i) drive.scan_headers.push_back({std::to_string(i), i * kPeriod, i * kPeriod, i * kPeriod, {}});
  drive.scans =
      Lazy<Scan>(drive.scan_headers.size(), [](std::size_t i) { return Room().scan(hand(static_cast<int>(i)), i + 1); });
  const Odometry found = odometry(drive, {});
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  ASSERT_EQ(found.world_from_lidar.poses().size(), 40U);
  for (int i = 0; i < 40; ++i) {
    const SE3 off =
        found.world_from_lidar.poses()[static_cast<std::size_t>(i)].world_from_body.inverse() * hand(0).inverse() * hand(i);
    EXPECT_LT(off.t.norm(), 0.01) << i;
    EXPECT_LT(so3_log(off.R).norm(), 0.005) << i;
  }
}

TEST(ForSensor, TakesRangeAndLengthsOfRoomsForADepthCamera) {
  Drive drive;
  const OdometryOptions options;
  EXPECT_EQ(for_sensor(options, drive).max_range_m, 120);
  EXPECT_EQ(for_sensor(options, drive).voxel_m, options.voxel_m);
  drive.sensor = Sensor::depth_camera;
  EXPECT_EQ(for_sensor(options, drive).max_range_m, 10);
  EXPECT_LT(for_sensor(options, drive).voxel_m, options.voxel_m);
  OdometryOptions given;
  given.max_range_m = 4;
  EXPECT_EQ(for_sensor(given, drive).max_range_m, 4);
}

}  // namespace
}  // namespace dvi::odometry
