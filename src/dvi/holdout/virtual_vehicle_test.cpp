#include "dvi/holdout/virtual_vehicle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dvi/core/threads.h"

namespace dvi::holdout {
namespace {

constexpr int kScans = 11;
constexpr double kHeightM = 1.7;  // height of the LiDAR
constexpr double kClearanceM = 0.2;
constexpr std::uint64_t kSeed = 6;

/// A vertical post with the given range of heights.
std::vector<Eigen::Vector3d> make_post(double x, double y, double from = 0.5, double to = 3) {
  std::vector<Eigen::Vector3d> points;
  for (double z = from; z < to; z += 0.125) points.emplace_back(x, y, z);
  return points;
}

/// A drive along x at 10 m/s on the plane z = 0. Each scan shows the ground around it and `obstacles`, each return from the
/// position of the LiDAR at its own time.
Drive drive_past(const std::vector<Eigen::Vector3d>& obstacles) {
  Drive drive;
  std::vector<StampedPose> poses;
  for (int i = 0; i < kScans; ++i) {
    const std::int64_t time = i * 100'000'000LL;
    drive.scan_headers.push_back({std::to_string(i), time, time - 50'000'000, time + 50'000'000, {}});
    Frame frame;
    frame.time_ns = time;
    drive.frames.push_back(frame);
    poses.push_back({time, SE3{Eigen::Matrix3d::Identity(), {i * 1.0, 0, kHeightM}}});
  }
  drive.poses = Trajectory(poses);
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  drive.scans = Lazy<Scan>(kScans, kScans, [obstacles](std::size_t index) {
    Scan scan;
    const auto add = [&](const Eigen::Vector3d& lidar_point, float time) {
      scan.points.push_back(lidar_point.cast<float>()), scan.time.push_back(time), scan.intensity.push_back(0);
    };
    for (double x = -30; x < 30; x += 0.5)
      for (double y = -5; y < 5; y += 0.5) add({x, y, -kHeightM}, 0);
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      const double time = k % 2 == 0 ? -0.04 : 0.04;
      add(obstacles[k] - Eigen::Vector3d(static_cast<double>(index) + 10 * time, 0, kHeightM), static_cast<float>(time));
    }
    return scan;
  });
  return drive;
}

VirtualVehicle park(const Drive& drive) {
  VirtualVehicle vehicle(Scenario::parked, kSeed, std::make_shared<const DrivenPath>(drive, drive.poses),
                         {drive.frames.front().time_ns, drive.frames.back().time_ns});
  vehicle.avoid_obstacles(drive, drive.poses);
  return vehicle;
}

Eigen::Vector3d position(const VirtualVehicle& vehicle) { return vehicle.box_at(0).frame_from_box.t; }

/// Returns its position without obstacles.
const Eigen::Vector3d& drawn() {
  static const Eigen::Vector3d position_drawn = position(park(drive_past({})));
  return position_drawn;
}

TEST(Parked, KeepsItsPositionWithoutObstacles) {
  const double half_length = 2.1 + kClearanceM, half_width = 0.9 + kClearanceM;
  std::vector<Eigen::Vector3d> obstacles;
  for (const auto& [x, y] :
       {std::pair{half_length + 0.02, 0.0}, {-half_length - 0.02, 0.0}, {0.0, half_width + 0.02}, {0.0, -half_width - 0.02}})
    for (const Eigen::Vector3d& p : make_post(drawn().x() + x, drawn().y() + y)) obstacles.push_back(p);
  for (const Eigen::Vector3d& p : make_post(drawn().x(), drawn().y(), 0, 0.28)) obstacles.push_back(p);         // a curb
  for (const Eigen::Vector3d& p : make_post(drawn().x(), drawn().y(), 1.55 + 0.25, 3)) obstacles.push_back(p);  // a branch
  const VirtualVehicle vehicle = park(drive_past(obstacles));
  EXPECT_EQ(vehicle.avoidance()->moved_m, 0);
  EXPECT_EQ(vehicle.avoidance()->returns, 0);
  EXPECT_LT((position(vehicle) - drawn()).norm(), 1e-6);
}

TEST(Parked, MovesToTheNearestFreePosition) {
  // 2.3 m to both sides of its center must be free: 1.6 m backward suffices, or 3 m ahead.
  const VirtualVehicle back = park(drive_past(make_post(drawn().x() + 0.7, drawn().y() - 0.5)));
  EXPECT_DOUBLE_EQ(back.avoidance()->moved_m, -1.75);
  EXPECT_EQ(back.avoidance()->returns, 0);
  EXPECT_NEAR(position(back).x(), drawn().x() - 1.75, 1e-6);
  EXPECT_NEAR(position(back).y(), drawn().y(), 1e-6);

  const VirtualVehicle ahead = park(drive_past(make_post(drawn().x() - 0.7, drawn().y() + 0.5)));
  EXPECT_DOUBLE_EQ(ahead.avoidance()->moved_m, 1.75);

  // The nearest allowed position is 10 m ahead and the drawn one less than 14 m: the post is too close to its front.
  ASSERT_LT(drawn().x(), 14);
  std::vector<Eigen::Vector3d> two = make_post(drawn().x() - 1.5, drawn().y());
  for (const Eigen::Vector3d& p : make_post(drawn().x() + 2, drawn().y())) two.push_back(p);
  EXPECT_DOUBLE_EQ(park(drive_past(two)).avoidance()->moved_m, 4.5);
}

/// A labeled post with a box around it in every frame, stationary or moving.
Drive drive_past_labeled(double meters_per_frame) {
  Drive drive = drive_past(make_post(drawn().x(), drawn().y()));
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const double moved = meters_per_frame * (static_cast<double>(i) - kScans / 2);
    Label label;
    label.track = 3;
    label.box = {SE3{Eigen::Matrix3d::Identity(), drawn() + Eigen::Vector3d(moved - static_cast<double>(i), 0, -kHeightM)},
                 {4, 2, 6}};
    drive.frames[i].labels.push_back(label);
  }
  return drive;
}

TEST(Parked, AvoidsStationaryLabeledTraffic) {
  EXPECT_EQ(park(drive_past_labeled(0)).avoidance()->moved_m, 2.5);
  EXPECT_EQ(park(drive_past_labeled(0.15)).avoidance()->moved_m, 0);
}

TEST(Parked, DoesNotDependOnTheNumberOfThreads) {
  const Drive drive = drive_past(make_post(drawn().x(), drawn().y()));
  const ThreadLimit limit(1);
  const VirtualVehicle one = park(drive);
  const ThreadLimit higher(2);
  const VirtualVehicle two = park(drive);
  EXPECT_EQ(position(one), position(two));
  EXPECT_EQ(one.avoidance()->moved_m, 2.5);
}

TEST(Parked, MovesToThePositionWithTheFewestReturnsIfNoneIsFree) {
  // A wall of posts that is lower over 6 m, from 4 m ahead of the drawn position.
  std::vector<Eigen::Vector3d> wall;
  for (double x = -20; x < 25; x += 0.25)
    for (const Eigen::Vector3d& p : make_post(drawn().x() + x + 0.125, drawn().y(), 0.5, x >= 4 && x < 10 ? 0.6 : 1.5))
      wall.push_back(p);
  const VirtualVehicle vehicle = park(drive_past(wall));
  // 18 posts with one return per scan fit into the 4.6 m of the box and its clearance.
  EXPECT_DOUBLE_EQ(vehicle.avoidance()->moved_m, 6.25);
  EXPECT_EQ(vehicle.avoidance()->returns, 18 * kScans);
}

}  // namespace
}  // namespace dvi::holdout
