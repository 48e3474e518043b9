#include "dvi/holdout/virtual_vehicle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dvi/core/threads.h"

namespace dvi::holdout {
namespace {

constexpr int kScans = 11;
constexpr double kHeight = 1.7;  // meters of the LiDAR
constexpr double kClearance = 0.2;
constexpr std::uint64_t kSeed = 6;

// A post on the ground of the world.
std::vector<Eigen::Vector3d> post(double x, double y, double from = 0.5, double to = 3) {
  std::vector<Eigen::Vector3d> points;
  for (double z = from; z < to; z += 0.125) points.emplace_back(x, y, z);
  return points;
}

// Straight ahead along x at 10 m/s on the plane z = 0: each scan sees the ground round it, and `things`, each return from
// where the LiDAR is at its own time.
Drive drive_past(const std::vector<Eigen::Vector3d>& things) {
  Drive drive;
  std::vector<StampedPose> poses;
  for (int i = 0; i < kScans; ++i) {
    const std::int64_t time = i * 100'000'000LL;
    drive.scan_headers.push_back({std::to_string(i), time, time - 50'000'000, time + 50'000'000, {}});
    Frame frame;
    frame.time_ns = time;
    drive.frames.push_back(frame);
    poses.push_back({time, SE3{Eigen::Matrix3d::Identity(), {i * 1.0, 0, kHeight}}});
  }
  drive.poses = Trajectory(poses);
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  drive.scans = Lazy<Scan>(kScans, kScans, [things](std::size_t index) {
    Scan scan;
    const auto add = [&](const Eigen::Vector3d& lidar_point, float time) {
      scan.points.push_back(lidar_point.cast<float>()), scan.time.push_back(time), scan.intensity.push_back(0);
    };
    for (double x = -30; x < 30; x += 0.5)
      for (double y = -5; y < 5; y += 0.5) add({x, y, -kHeight}, 0);
    for (std::size_t k = 0; k < things.size(); ++k) {
      const double time = k % 2 == 0 ? -0.04 : 0.04;
      add(things[k] - Eigen::Vector3d(static_cast<double>(index) + 10 * time, 0, kHeight), static_cast<float>(time));
    }
    return scan;
  });
  return drive;
}

VirtualVehicle parked(const Drive& drive) {
  VirtualVehicle vehicle(Scenario::parked, kSeed, std::make_shared<const DrivenPath>(drive, drive.poses),
                         drive.frames.front().time_ns, drive.frames.back().time_ns);
  vehicle.stand_clear(drive, drive.poses);
  return vehicle;
}

Eigen::Vector3d place(const VirtualVehicle& vehicle) { return vehicle.at(0).frame_from_box.t; }

// Where it stands if nothing is in its way.
const Eigen::Vector3d& drawn() {
  static const Eigen::Vector3d place_drawn = place(parked(drive_past({})));
  return place_drawn;
}

TEST(Parked, StaysWhereItWasDrawnIfNothingIsThere) {
  const double half_length = 2.1 + kClearance, half_width = 0.9 + kClearance;
  std::vector<Eigen::Vector3d> things;
  for (const auto& [x, y] :
       {std::pair{half_length + 0.02, 0.0}, {-half_length - 0.02, 0.0}, {0.0, half_width + 0.02}, {0.0, -half_width - 0.02}})
    for (const Eigen::Vector3d& p : post(drawn().x() + x, drawn().y() + y)) things.push_back(p);
  for (const Eigen::Vector3d& p : post(drawn().x(), drawn().y(), 0, 0.28)) things.push_back(p);         // a curb
  for (const Eigen::Vector3d& p : post(drawn().x(), drawn().y(), 1.55 + 0.25, 3)) things.push_back(p);  // a bough
  const VirtualVehicle vehicle = parked(drive_past(things));
  EXPECT_EQ(vehicle.stand()->moved, 0);
  EXPECT_EQ(vehicle.stand()->returns, 0);
  EXPECT_LT((place(vehicle) - drawn()).norm(), 1e-6);
}

TEST(Parked, MovesToTheNearestFreePlace) {
  // 2.3 m free to either side of its middle: 1.6 m back would do, or 3 m ahead.
  const VirtualVehicle back = parked(drive_past(post(drawn().x() + 0.7, drawn().y() - 0.5)));
  EXPECT_DOUBLE_EQ(back.stand()->moved, -1.75);
  EXPECT_EQ(back.stand()->returns, 0);
  EXPECT_NEAR(place(back).x(), drawn().x() - 1.75, 1e-6);
  EXPECT_NEAR(place(back).y(), drawn().y(), 1e-6);

  const VirtualVehicle ahead = parked(drive_past(post(drawn().x() - 0.7, drawn().y() + 0.5)));
  EXPECT_DOUBLE_EQ(ahead.stand()->moved, 1.75);

  // The place nearest to the camera is 10 m ahead, and the one drawn is less than 14 m: the post is too near to its front.
  ASSERT_LT(drawn().x(), 14);
  std::vector<Eigen::Vector3d> two = post(drawn().x() - 1.5, drawn().y());
  for (const Eigen::Vector3d& p : post(drawn().x() + 2, drawn().y())) two.push_back(p);
  EXPECT_DOUBLE_EQ(parked(drive_past(two)).stand()->moved, 4.5);
}

// A post that is labeled: a box round it in every frame, all the time at one place, or moving.
Drive drive_past_labeled(double meters_per_frame) {
  Drive drive = drive_past(post(drawn().x(), drawn().y()));
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const double moved = meters_per_frame * (static_cast<double>(i) - kScans / 2);
    Label label;
    label.track = 3;
    label.box = {SE3{Eigen::Matrix3d::Identity(), drawn() + Eigen::Vector3d(moved - static_cast<double>(i), 0, -kHeight)},
                 {4, 2, 6}};
    drive.frames[i].labels.push_back(label);
  }
  return drive;
}

TEST(Parked, KeepsClearOfLabeledTrafficUnlessItMoves) {
  EXPECT_EQ(parked(drive_past_labeled(0)).stand()->moved, 2.5);
  EXPECT_EQ(parked(drive_past_labeled(0.15)).stand()->moved, 0);
}

TEST(Parked, IsTheSameWithAnyNumberOfThreads) {
  const Drive drive = drive_past(post(drawn().x(), drawn().y()));
  const ThreadLimit limit(1);
  const VirtualVehicle one = parked(drive);
  const ThreadLimit higher(2);
  const VirtualVehicle two = parked(drive);
  EXPECT_EQ(place(one), place(two));
  EXPECT_EQ(one.stand()->moved, 2.5);
}

TEST(Parked, TakesThePlaceWithTheFewestReturnsWhereNoneIsFree) {
  // A wall of posts, thinner over 6 m that begin 4 m ahead of the place drawn.
  std::vector<Eigen::Vector3d> wall;
  for (double x = -20; x < 25; x += 0.25)
    for (const Eigen::Vector3d& p : post(drawn().x() + x + 0.125, drawn().y(), 0.5, x >= 4 && x < 10 ? 0.6 : 1.5))
      wall.push_back(p);
  const VirtualVehicle vehicle = parked(drive_past(wall));
  // 18 posts of one return each fit into the 4.6 m of the box and its clearance, from every scan.
  EXPECT_DOUBLE_EQ(vehicle.stand()->moved, 6.25);
  EXPECT_EQ(vehicle.stand()->returns, 18 * kScans);
}

}  // namespace
}  // namespace dvi::holdout
