#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "dvi/core/random.h"
#include "dvi/core/threads.h"
#include "dvi/drive/deskew.h"
#include "dvi/drive/free_space.h"
#include "dvi/geometry/angles.h"
#include "dvi/map/build_map.h"
#include "dvi/map/voxel_grid.h"
#include "dvi/synth/scene.h"

namespace dvi::map {
namespace {

constexpr std::int64_t kMs = 1'000'000;

MapOptions make_options(bool carve = true) {
  MapOptions options;
  options.require_camera_visibility = false;
  options.carve = carve;
  return options;
}

Lazy<cv::Mat1b> make_empty_masks(const Drive& drive) {
  return {drive.frames.size(), 1,
          [size = cv::Size(drive.camera.width, drive.camera.height)](std::size_t) { return cv::Mat1b(size, uchar{0}); }};
}

/// The voxels of a map that contain a point.
class OccupiedVoxels {
 public:
  OccupiedVoxels(const StaticMap& map, double voxel_m) : grid_(voxel_m) {
    for (const MapPoint& point : map.points) grid_.at(point.position.cast<double>()) = 1;
  }
  bool contain(const Eigen::Vector3d& x) const { return grid_.find(grid_.index(x)) != nullptr; }

 private:
  VoxelGrid<char> grid_;
};

/// The synthetic street without masks and labels, with the object of each return.
struct UnlabeledStreet {
  Drive drive;
  std::vector<synth::SynthScan> scans;

  explicit UnlabeledStreet(int frames) {
    synth::SynthOptions options;
    options.frames = frames;
    options.columns = 900;
    options.width = 160;
    options.height = 90;
    const auto scene = std::make_shared<const synth::Scene>(options);
    drive = synth::drive_of(scene);
    for (Frame& frame : drive.frames) frame.labels.clear();
    for (int i = 0; i < frames; ++i) scans.push_back(scene->scan(i));
    drive.scans = Lazy<Scan>(scans.size(), scans.size(), [this](std::size_t i) { return scans[i].scan; });
  }
};

TEST(Carve, KeepsTheStreetAndRemovesTrafficWithoutLabels) {
  const UnlabeledStreet street(30);
  // Poses with the noise of a good GNSS.
  Random random(3);
  std::vector<StampedPose> poses = street.drive.poses.poses();
  for (StampedPose& pose : poses)
    for (double& x : pose.world_from_body.t) x += 0.03 * random.normal();
  const Trajectory noisy(poses);
  const MapOptions options = make_options();
  const StaticMap map = build_map({{&street.drive, noisy, make_empty_masks(street.drive)}}, options);
  const OccupiedVoxels occupied(map, options.voxel_m);
  double count[2]{}, kept[2]{};  // static and dynamic returns
  for (std::size_t i = 0; i < street.scans.size(); ++i) {
    const synth::SynthScan& scan = street.scans[i];
    const std::vector<Eigen::Vector3d> world = to_world(scan.scan, street.drive.scan_headers[i], noisy);
    for (std::size_t k = 0; k < world.size(); ++k) {
      if (scan.range[k] < 2.2F || scan.range[k] > 119.8F) continue;
      ++count[scan.dynamic[k]];
      kept[scan.dynamic[k]] += occupied.contain(world[k]) ? 1 : 0;
    }
  }
  EXPECT_GE(kept[0] / count[0], 0.98);
  EXPECT_LE(kept[1] / count[1], 0.02);
  RecordProperty("static_kept", std::to_string(kept[0] / count[0]));
  RecordProperty("dynamic_removed", std::to_string(1 - kept[1] / count[1]));
}

/// Returns the range of a ray from 1.7 m above a plane. The recording car moves along x at 8 m/s.
using World = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double time)>;

double ground(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  return ray.z() < 0 ? (-1.7 - origin.z()) / ray.z() : 1e9;
}

double facades(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  return ((ray.y() > 0 ? 12 : -12) - origin.y()) / (std::abs(ray.y()) < 1e-9 ? 1e-9 : ray.y());
}

double pole(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, const Eigen::Vector2d& foot, double radius) {
  const Eigen::Vector2d to = foot - origin.head<2>(), direction = ray.head<2>().normalized();
  const double along = to.dot(direction), off = std::abs(to.x() * direction.y() - to.y() * direction.x());
  return along > 0 && off < radius ? (along - std::sqrt(radius * radius - off * off)) / ray.head<2>().norm() : 1e9;
}

double box(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, const Eigen::AlignedBox3d& bounds) {
  const Eigen::Array3d a = (bounds.min() - origin).array() / ray.array(), b = (bounds.max() - origin).array() / ray.array();
  const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
  return in > 0 && in < out ? in : 1e9;
}

Eigen::AlignedBox3d car_at(double x, double y) {
  return {Eigen::Vector3d(x, y, -1.65), Eigen::Vector3d(x + 4.2, y + 1.8, -0.2)};
}

Drive make_plane_drive(int scans, const World& world) {
  Drive drive;
  drive.camera = {160, 90, 130, 130, 79.5, 44.5, {}};
  std::vector<StampedPose> poses;
  for (int i = -1; i <= scans; ++i) {
    poses.push_back({i * 100 * kMs, {Eigen::Matrix3d::Identity(), {0.8 * i, 0, 0}}});
    if (i < 0 || i == scans) continue;
    drive.scan_headers.push_back({"", i * 100 * kMs, i * 100 * kMs - 50 * kMs, i * 100 * kMs + 50 * kMs, {}});
  }
  drive.poses = Trajectory(poses);
  const auto count = static_cast<std::size_t>(scans);
  drive.scans = Lazy<Scan>(count, count, [world](std::size_t i) {
    Random random(i + 1);
    Scan scan;
    for (int column = 0; column < 900; ++column)
      for (int beam = 0; beam < 64; ++beam) {
        const double after = 0.1 * ((column + 0.5) / 900 - 0.5), time = 0.1 * static_cast<double>(i) + after;
        const double azimuth = std::numbers::pi * (1 - 2 * (column + 0.5) / 900);
        const double up = to_radians(-24.8 + 26.8 * beam / 63);
        const Eigen::Vector3d ray(std::cos(up) * std::cos(azimuth), std::cos(up) * std::sin(azimuth), std::sin(up));
        const double range = world({8 * time, 0, 0}, ray, time) + 0.02 * random.normal();
        if (range > 100) continue;
        scan.points.emplace_back((range * ray).cast<float>());
        scan.intensity.push_back(0.5F);
        scan.time.push_back(static_cast<float>(after));
      }
    return scan;
  });
  return drive;
}

/// A plane between facades with a thin pole, a parked car, an oncoming car, and a car that waits for a second.
double trace_traffic(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double time) {
  const double waiting = 14 + 12 * std::max(0.0, time - 1);
  return std::min({ground(origin, ray), facades(origin, ray), pole(origin, ray, {12, 5}, 0.05),
                   box(origin, ray, car_at(10, -7)), box(origin, ray, car_at(40 - 10 * time, 2.5)),
                   box(origin, ray, car_at(waiting, -3.5))});
}

std::size_t points_in(const StaticMap& map, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const Eigen::AlignedBox3f bounds(low.cast<float>(), high.cast<float>());
  return static_cast<std::size_t>(
      std::count_if(map.points.begin(), map.points.end(), [&](const MapPoint& p) { return bounds.contains(p.position); }));
}

TEST(Carve, KeepsThinObjectsParkedCarsAndTheGround) {
  const Drive drive = make_plane_drive(25, trace_traffic);
  const MapInput input{&drive, drive.poses, make_empty_masks(drive)};
  const StaticMap all = build_map({input}, make_options(false)), map = build_map({input}, make_options());
  const auto kept = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    EXPECT_GT(points_in(all, low, high), 50U);
    return static_cast<double>(points_in(map, low, high)) / static_cast<double>(points_in(all, low, high));
  };
  EXPECT_GT(kept({11.8, 4.8, -1.5}, {12.2, 5.2, 1}), 0.95) << "the pole";
  EXPECT_GT(kept({9.5, -7.5, -1.5}, {14.5, -5, 0}), 0.98) << "the parked car";
  EXPECT_GT(kept({-30, -12.1, -1.8}, {60, 12.1, -1.62}), 0.995) << "the ground";
  EXPECT_GT(kept({-30, -12.2, -1.5}, {60, -11.8, 2}), 0.99) << "the facade";
  EXPECT_LT(kept({10, 2.3, -1.4}, {40, 4.5, 0}), 0.02) << "the oncoming car";
  EXPECT_LT(kept({13.8, -3.7, -1.4}, {30, -1.5, 0}), 0.02) << "the car that waited";
  EXPECT_EQ(all.counts.moved, 0U);
  EXPECT_GT(map.counts.moved, 0U);
  for (const RemovedPoint& point : map.removed) EXPECT_EQ(point.cause, Cause::moved);
  EXPECT_EQ(map.points.size() + map.removed.size(), all.points.size());
}

// A truck is parked on the first day only, a car next to it on the second.
TEST(Carve, KeepsParkedVehiclesPerDay) {
  const Eigen::AlignedBox3d truck(Eigen::Vector3d(10, -7, -1.65), Eigen::Vector3d(20, -4.5, 1.8)), car = car_at(24, -7);
  const auto day = [](const Eigen::AlignedBox3d& parked) {
    return make_plane_drive(20, [parked](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double) {
      return std::min({ground(origin, ray), facades(origin, ray), box(origin, ray, parked)});
    });
  };
  const std::array<Drive, 2> drives{day(truck), day(car)};
  for (const std::size_t target : {0, 1}) {
    const Drive &first = drives[target], &second = drives[1 - target];
    const StaticMap map = build_map(
        {{&first, first.poses, make_empty_masks(first)}, {&second, second.poses, make_empty_masks(second)}}, make_options());
    const auto share = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high, std::size_t drive) {
      const Eigen::AlignedBox3f bounds(low.cast<float>(), high.cast<float>());
      double count = 0, present = 0;
      for (const MapPoint& point : map.points)
        if (bounds.contains(point.position)) ++count, present += point.is_present_in(drive) ? 1 : 0;
      EXPECT_GT(count, 50);
      return present / count;
    };
    const std::size_t on_first = target, on_second = 1 - target;  // index of the drive of each day
    const Eigen::Vector3d truck_low(9.8, -7, -1.3), truck_high(20.2, -4.4, 1.2), car_low(23.8, -7, -1.3), car_high(28.4, -5, 0);
    EXPECT_GT(share(truck_low, truck_high, on_first), 0.98);
    EXPECT_LT(share(truck_low, truck_high, on_second), 0.02);
    EXPECT_GT(share(car_low, car_high, on_second), 0.98);
    EXPECT_LT(share(car_low, car_high, on_first), 0.02);
    EXPECT_GT(share({-30, -12.2, -1.5}, {60, -11.8, 2}, on_first), 0.99) << "the facade";
    EXPECT_GT(share({-30, -12.2, -1.5}, {60, -11.8, 2}, on_second), 0.99);
  }
}

TEST(Carve, DoesNotDependOnTheNumberOfThreads) {
  const Drive drive = make_plane_drive(5, trace_traffic);
  StaticMap maps[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    maps[threads - 1] = build_map({{&drive, drive.poses, make_empty_masks(drive)}}, make_options());
  }
  ASSERT_EQ(maps[0].points.size(), maps[1].points.size());
  ASSERT_EQ(maps[0].removed.size(), maps[1].removed.size());
  for (std::size_t i = 0; i < maps[0].points.size(); ++i) {
    ASSERT_EQ(maps[0].points[i].position, maps[1].points[i].position);
    ASSERT_EQ(maps[0].points[i].normal, maps[1].points[i].normal);
  }
  for (std::size_t i = 0; i < maps[0].removed.size(); ++i) ASSERT_EQ(maps[0].removed[i].position, maps[1].removed[i].position);
}

TEST(Carve, AcceptsAnEmptyScanAndOneWithoutPose) {
  Drive drive = make_plane_drive(3, trace_traffic);
  drive.scan_headers[2].time_ns = 10'000 * kMs;
  drive.scans = Lazy<Scan>(3, 3, [scans = drive.scans](std::size_t i) { return i == 1 ? Scan() : *scans[i]; });
  const StaticMap map = build_map({{&drive, drive.poses, make_empty_masks(drive)}}, make_options());
  EXPECT_EQ(map.counts.scans_without_pose, 2U);
  EXPECT_FALSE(map.points.empty());
}

TEST(FreeSpace, DistinguishesHitPassedAndHidden) {
  const Drive drive = make_plane_drive(
      1, [](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double) { return std::min(ground(origin, ray), 20.0); });
  const FreeSpace space(*drive.scans[0], drive.scan_headers[0], drive.poses, 0.05);
  ASSERT_TRUE(space.valid());
  using Seen = FreeSpace::Seen;
  const auto seen = [&](double x, double y, double z) { return space.judge({x, y, z}, 0.025); };
  EXPECT_EQ(seen(10, 3, 0), Seen::passed);
  EXPECT_EQ(seen(-10, 3, -0.5), Seen::passed);
  EXPECT_EQ(seen(0, 20, 0), Seen::hit);
  EXPECT_EQ(seen(10, 3, -1.7), Seen::hit) << "the ground";
  EXPECT_EQ(seen(10, 3, -1.65), Seen::hit) << "just above the ground, within the error of a ray";
  EXPECT_EQ(seen(24, 3, 0), Seen::hidden);
  EXPECT_EQ(seen(10, 0, 4), Seen::unknown) << "above all beams";
  EXPECT_EQ(seen(0.5, 0, 0), Seen::unknown) << "too close";
  EXPECT_EQ(seen(90, 0, 0), Seen::unknown) << "too far";
  EXPECT_TRUE(space.is_above({10, 0, 4}));
  EXPECT_FALSE(space.is_above({10, 3, 0}));
  EXPECT_FALSE(space.is_above({10, 3, -1.7}));
  EXPECT_FALSE(FreeSpace().is_above({10, 0, 4})) << "without a scan";
}

TEST(FreeSpace, IsInFrontOfReturnsFromAnyDistance) {
  const Drive drive = make_plane_drive(1, [](const Eigen::Vector3d&, const Eigen::Vector3d&, double) { return 20.0; });
  for (const double wall_m : {20.0, 79.9, 127.9, 128.1, 190.0, 4000.0}) {
    const Lazy<Scan> far(1, 1, [scans = drive.scans, scale = static_cast<float>(wall_m / 20)](std::size_t i) {
      Scan scan = *scans[i];
      for (Eigen::Vector3f& point : scan.points) point *= scale;
      return scan;
    });
    const FreeSpace space(*far[0], drive.scan_headers[0], drive.poses, 0.05);
    for (const double x : {5.0, 19.0, 21.0, 60.0, 79.0})
      EXPECT_EQ(space.judge({x, 0, 0}, 0.05), x < wall_m ? FreeSpace::Seen::passed : FreeSpace::Seen::hidden)
          << x << " m, in front of a wall at " << wall_m << " m";
  }
}

TEST(Normals, PointTowardTheSensor) {
  const Drive drive = make_plane_drive(3, [](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double) {
    return std::min(ground(origin, ray), facades(origin, ray));
  });
  const StaticMap map = build_map({{&drive, drive.poses, make_empty_masks(drive)}}, make_options());
  std::size_t level = 0, facing = 0, with_level = 0, with_facing = 0;
  for (const MapPoint& point : map.points) {
    if (point.position.head<2>().norm() > 12 || point.normal.isZero()) continue;
    if (std::abs(point.position.y()) < 11) {
      ++level;
      with_level += point.normal.z() > 0.97F ? 1 : 0;
    } else if (point.position.z() > -1) {
      ++facing;
      with_facing += point.normal.y() * point.position.y() < -0.97F * 11 ? 1 : 0;
    }
    EXPECT_LE(point.first, point.last);
  }
  EXPECT_GT(level, 1000U);
  EXPECT_GT(facing, 100U);
  EXPECT_GT(static_cast<double>(with_level), 0.95 * static_cast<double>(level));
  EXPECT_GT(static_cast<double>(with_facing), 0.95 * static_cast<double>(facing));
}

}  // namespace
}  // namespace dvi::map
