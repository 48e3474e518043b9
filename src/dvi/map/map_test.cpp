#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dvi/core/random.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"
#include "dvi/map/build_map.h"
#include "dvi/map/visible_points.h"

namespace dvi::map {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;

/// A car at 10 m/s along x that passes static points; each is measured at its own time in the scan.
struct MovingCar {
  std::vector<Eigen::Vector3d> world;
  Trajectory poses;
  ScanHeader header;
  Scan scan;

  explicit MovingCar(double turn_rate = 0.3) {
    std::vector<StampedPose> stamped;
    for (int i = -2; i <= 2; ++i) {
      const double t = 0.1 * i;
      SE3 pose{so3_exp({0, 0, turn_rate * t}), {0, 0, 0}};
      // A circle, so that constant twist between stamps is the exact motion.
      const double r = 10 / turn_rate;
      pose.t = {r * std::sin(turn_rate * t), r * (1 - std::cos(turn_rate * t)), 0};
      stamped.push_back({i * 100 * kMillisecondNs, pose});
    }
    poses = Trajectory(stamped);
    header = {"0", 0, -50 * kMillisecondNs, 50 * kMillisecondNs, {}};
    Random random(4);
    for (int i = 0; i < 500; ++i) {
      world.push_back({random.uniform(5, 40), random.uniform(-15, 15), random.uniform(-1, 5)});
      const double t = random.uniform(-0.05, 0.05);
      const SE3 pose = *poses.at(static_cast<std::int64_t>(std::llround(t * 1e9)));
      scan.points.push_back((pose.inverse() * world.back()).cast<float>());
      scan.time.push_back(static_cast<float>(t));
      scan.intensity.push_back(0.5F);
    }
  }
};

TEST(Deskew, CompensatesTheMotionOfTheCar) {
  const MovingCar car;
  const auto points = to_world(car.scan, car.header, car.poses);
  ASSERT_EQ(points.size(), car.world.size());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - car.world[i]).norm(), 0.008) << i;
}

TEST(Deskew, ReturnsNothingWithoutPose) {
  MovingCar car;
  car.header.time_ns = 10'000 * kMillisecondNs;
  EXPECT_TRUE(to_world(car.scan, car.header, car.poses).empty());
}

/// A wall at x = 20 and a box in front of it, one frame and one scan at the same time, camera along x.
Drive make_wall_drive() {
  Drive drive;
  drive.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  drive.frames.resize(1);
  drive.frames[0].time_ns = 0;
  drive.scan_headers.push_back({"0", 0, -50 * kMillisecondNs, 50 * kMillisecondNs, {}});
  drive.scans = Lazy<Scan>(1, 1, [](std::size_t) {
    Scan scan;
    const auto add = [&](float x, float y, float z) {
      scan.points.emplace_back(x, y, z);
      scan.intensity.push_back(1);
      scan.time.push_back(0);
    };
    for (int i = -40; i <= 40; ++i) add(20.02F, 0.2F * static_cast<float>(i), 0);    // the wall
    for (int i = -5; i <= 5; ++i) add(10.02F, 0.1F * static_cast<float>(i), 0.02F);  // the car
    add(-10.02F, 0, 0);                                                              // behind the camera
    add(0.5F, 0, 0);                                                                 // the roof of the ego vehicle
    return scan;
  });
  return drive;
}

Trajectory make_stationary() { return Trajectory({{-200 * kMillisecondNs, {}}, {200 * kMillisecondNs, {}}}); }

Lazy<cv::Mat1b> make_mask(const cv::Rect& hole) {
  return {1, 1, [hole](std::size_t) {
            cv::Mat1b mask(100, 200, uchar{0});
            mask(hole) = 255;
            return mask;
          }};
}

bool has_point_at_x(const StaticMap& map, float x) {
  for (const MapPoint& p : map.points)
    if (std::abs(p.position.x() - x) < 0.05F) return true;
  return false;
}

TEST(BuildMap, DropsMaskedPointsAndTheEgoVehicle) {
  const Drive drive = make_wall_drive();
  MapOptions options;
  options.require_camera_visibility = false;
  const StaticMap map = build_map({{&drive, make_stationary(), make_mask({89, 40, 22, 20})}}, options);
  EXPECT_FALSE(has_point_at_x(map, 10.02F));
  EXPECT_TRUE(has_point_at_x(map, 20.02F));
  EXPECT_TRUE(has_point_at_x(map, -10.02F));
  EXPECT_EQ(map.counts.returns, 81 + 11 + 2);
  EXPECT_EQ(map.counts.too_near, 1);
  EXPECT_GE(map.counts.masked, 11);
  EXPECT_EQ(map.points.size() + map.counts.masked + 1, map.counts.returns);
}

TEST(BuildMap, DepthCamerasHaveNoMinimumRange) {
  Drive drive = make_wall_drive();
  drive.sensor = Sensor::depth_camera;
  const auto too_near = [&](const MapOptions& options) {
    return build_map({{&drive, make_stationary(), make_mask({0, 0, 1, 1})}}, options).counts.too_near;
  };
  EXPECT_EQ(too_near({.min_range_m = {}, .max_range_m = 120}), 0);
  EXPECT_EQ(too_near({.min_range_m = 2, .max_range_m = 120}), 1) << "given by the user";
}

TEST(BuildMap, DropsPointsThatNoCameraObserved) {
  const Drive drive = make_wall_drive();
  const StaticMap map = build_map({{&drive, make_stationary(), make_mask({0, 0, 1, 1})}}, {});
  EXPECT_FALSE(has_point_at_x(map, -10.02F));
  EXPECT_EQ(map.counts.unseen_by_camera, 1);
}

TEST(BuildMap, DropsPointsInBoxes) {
  Drive drive = make_wall_drive();
  Label label;
  label.box = Box{{Eigen::Matrix3d::Identity(), {11, 0, 0}}, {2, 2, 2}};
  const StaticMap map = build_map({{&drive, make_stationary(), make_mask({0, 0, 1, 1}), shared({{label}})}}, {});
  EXPECT_EQ(map.counts.boxed, 11);
  EXPECT_FALSE(has_point_at_x(map, 10.02F));
}

TEST(BuildMap, CountsScansWithoutPose) {
  const Drive drive = make_wall_drive();
  const StaticMap map = build_map({{&drive, Trajectory(), make_mask({0, 0, 1, 1})}}, {});
  EXPECT_EQ(map.counts.scans_without_pose, 1);
  EXPECT_TRUE(map.points.empty());
}

/// Scans of `points` random returns each in a box.
Lazy<Scan> make_random_scans(std::size_t count, int points, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return Lazy<Scan>(count, count, [=](std::size_t i) {
    Random random(i);
    Scan scan;
    for (int k = 0; k < points; ++k) {
      Eigen::Vector3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(low[axis], high[axis]);
      scan.points.push_back(p.cast<float>());
      scan.intensity.push_back(static_cast<float>(random.uniform()));
      scan.time.push_back(0);
    }
    return scan;
  });
}

TEST(BuildMap, KeepsTheMeanOfEachVoxelWithAnyNumberOfThreads) {
  MovingCar car;
  Drive drive = make_wall_drive();
  drive.scan_headers.assign(6, drive.scan_headers[0]);
  drive.scans = make_random_scans(6, 2000, {10, -1, -1}, {11, 1, 1});
  MapOptions options;
  options.voxel_m = 0.25;
  StaticMap maps[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    maps[threads - 1] = build_map({{&drive, make_stationary(), make_mask({0, 0, 1, 1})}}, options);
  }
  ASSERT_EQ(maps[0].points.size(), maps[1].points.size());
  EXPECT_LE(maps[0].points.size(), 5 * 9 * 9);
  std::size_t count = 0;
  for (std::size_t i = 0; i < maps[0].points.size(); ++i) {
    EXPECT_EQ(maps[0].points[i].position, maps[1].points[i].position);
    EXPECT_EQ(maps[0].points[i].intensity, maps[1].points[i].intensity);
    count += maps[0].points[i].count;
  }
  EXPECT_EQ(count, 12000);
  EXPECT_EQ(maps[0].tiles.back().last, maps[0].points.size());
}

TEST(BuildMap, DoesNotDependOnTheMemoryBound) {
  Drive drive = make_wall_drive();
  drive.scan_headers.assign(4, drive.scan_headers[0]);
  drive.scans = make_random_scans(4, 20000, {5, -20, -1}, {60, 20, 1});
  View view;
  view.camera = drive.camera;
  view.camera_from_world = drive.camera_from_lidar;
  StaticMap maps[2];
  const std::shared_ptr<Scratch>& scratch = Scratch::of_process();
  const std::size_t bound = scratch->bound();
  for (const bool paged : {false, true}) {
    if (paged) scratch->set_bound(0);
    maps[paged ? 1 : 0] = build_map({{&drive, make_stationary(), make_mask({89, 40, 22, 20})}}, {});
    EXPECT_EQ(scratch->on_disk() > 0, paged);
  }
  scratch->set_bound(bound);
  ASSERT_EQ(maps[0].points.size(), maps[1].points.size());
  for (std::size_t i = 0; i < maps[0].points.size(); ++i) {
    const MapPoint &a = maps[0].points[i], &b = maps[1].points[i];
    ASSERT_TRUE(a.position == b.position && a.normal == b.normal && a.intensity == b.intensity && a.count == b.count) << i;
  }
  EXPECT_EQ(maps[0].removed.size(), maps[1].removed.size());
  const auto a = find_visible_points(maps[0], view, 0.07, 0.05), b = find_visible_points(maps[1], view, 0.07, 0.05);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i].index, b[i].index);
}

TEST(VisiblePoints, EndAtTheFarPlane) {
  StaticMap map;
  for (const float x : {49.0F, 51.0F}) {
    map.points.push_back({{x, 0.1F * (x - 50), 0}, 0, 1});
    const std::size_t n = map.points.size();
    map.tiles.push_back({Eigen::AlignedBox3f(map.points.back().position, map.points.back().position), n - 1, n});
  }
  View view;
  view.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const auto visible = find_visible_points(map, view, 0, 0.05);
  ASSERT_EQ(visible.size(), 1);
  EXPECT_EQ(visible[0].index, 0);
}

TEST(VisiblePoints, ExcludePointsBehindADisc) {
  StaticMap map;
  for (const float x : {10.0F, 20.0F}) map.points.push_back({{x, 0.01F * (x - 10), 0}, 0, 1});
  map.points.push_back({{20.0F, 5, 0}, 0, 1});
  map.tiles.push_back({Eigen::AlignedBox3f(Eigen::Vector3f(10, 0, 0), Eigen::Vector3f(20, 5, 0)), 0, 3});
  View view;
  view.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  EXPECT_EQ(find_visible_points(map, view, 0, 0.05).size(), 3) << "a pixel beside its nearer neighbor is visible";
  const auto visible = find_visible_points(map, view, 0.3, 0.05);
  ASSERT_EQ(visible.size(), 2);
  for (const VisiblePoint& p : visible) EXPECT_NE(p.index, 1);
  view.camera_from_world.t.z() = -30;  // all points behind
  EXPECT_TRUE(find_visible_points(map, view, 0.3, 0.05).empty());
}

TEST(VisiblePoints, ExcludePointsThatAreAbsentInTheDrive) {
  StaticMap map;
  for (const float x : {10.0F, 20.0F}) map.points.push_back({{x, 0, 0}, 0, 1});
  map.points[0].absent = MapPoint::drive_bit(1);
  map.tiles.push_back({Eigen::AlignedBox3f(Eigen::Vector3f(10, 0, 0), Eigen::Vector3f(20, 0, 0)), 0, 2});
  View view;
  view.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  for (const int drive : {0, 1, 2}) {
    view.drive = drive;
    const auto visible = find_visible_points(map, view, 0.3, 0.05);
    ASSERT_EQ(visible.size(), 1);
    EXPECT_EQ(visible[0].index, drive == 1 ? 1 : 0);
  }
}

}  // namespace
}  // namespace dvi::map
