#include "dvi/odometry/loop_closure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/testing/test_street.h"

namespace dvi::odometry {

namespace {

using testing::IsEmpty;

/// A row of houses on either side of a street along x, set back by `back` and more, with poles before them.
void add_street(TestStreet& world, double y, double back, std::uint64_t seed) {
  Random random(seed);
  for (const double side : {-1.0, 1.0})
    for (double x = -30 + random.uniform(0, 9); x < 110;) {
      const double length = random.uniform(6, 14), wall = side * (back + random.uniform(0, 2));
      world.add({x, y + std::min(wall, 20 * side), 0}, {x + length, y + std::max(wall, 20 * side), random.uniform(5, 9)});
      const double at = x + random.uniform(0, length);
      world.add({at, y + 6 * side - 0.1, 0}, {at + 0.2, y + 6 * side + 0.1, 5});
      x += length + random.uniform(1, 5);
    }
}

/// A flat ground without buildings.
TestStreet make_empty_world() {
  TestStreet world;
  world.boxes.clear();
  world.add({-500, -500, -1}, {500, 500, 0});
  return world;
}

constexpr double kRadiusM = 20;

/// A block of houses inside and around a circle of kRadiusM.
TestStreet make_block() {
  TestStreet world = make_empty_world();
  world.columns = 480;
  Random random(11);
  for (int i = 0; i < 24; ++i) {
    const double angle = i * 2 * std::numbers::pi / 24, radius = i % 2 == 0 ? random.uniform(8, 11) : random.uniform(29, 34);
    const Eigen::Vector3d at(radius * std::sin(angle), kRadiusM - radius * std::cos(angle), 0);
    world.add(at - Eigen::Vector3d(2.5, random.uniform(1.5, 3), 0), at + Eigen::Vector3d(2.5, 2, random.uniform(4, 9)));
    const double pole = random.uniform(24, 26), turn = random.uniform(0, 2 * std::numbers::pi);
    const Eigen::Vector3d foot(pole * std::sin(turn), kRadiusM - pole * std::cos(turn), 0);
    world.add(foot - Eigen::Vector3d(0.1, 0.1, 0), foot + Eigen::Vector3d(0.1, 0.1, 5));
  }
  return world;
}

/// Circles of 125 m, counter-clockwise around a block of houses, at `speed(seconds)`.
template <class Speed>
Trajectory make_circular_path(double seconds, const Speed& speed) {
  std::vector<StampedPose> poses;
  double path_m = 0;
  for (int i = -10; i < static_cast<int>(100 * seconds) + 10; ++i) {
    const double angle = path_m / kRadiusM;
    poses.push_back({i * TestStreet::kScanPeriodNs / 10,
                     {so3_exp({0, 0, angle}), {kRadiusM * std::sin(angle), kRadiusM * (1 - std::cos(angle)), 1.8}}});
    path_m += 0.01 * speed(0.01 * i);
  }
  return Trajectory(poses);
}

SE3 truth(const Trajectory& path, std::size_t i) { return *path.at(static_cast<std::int64_t>(i) * TestStreet::kScanPeriodNs); }

/// The result of odometry with these poses.
Odometry make_odometry(const std::vector<SE3>& poses) {
  Odometry out;
  std::vector<StampedPose> stamped;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    stamped.push_back({static_cast<std::int64_t>(i) * TestStreet::kScanPeriodNs, poses[i]});
    out.scans.emplace_back();
    out.scans.back().information = 1e5 * Matrix6d::Identity();
  }
  out.world_from_lidar = Trajectory(stamped);
  return out;
}

const SE3& pose(const Odometry& odometry, std::size_t i) { return odometry.world_from_lidar.poses()[i].world_from_body; }

double distance_m(const SE3& found, const SE3& expected) { return (found.inverse() * expected).t.norm(); }

TEST(LoopClosure, AlignsTwoPassesAndRemovesDrift) {
  const Trajectory path = make_circular_path(15.5, [](double) { return 10.0; });
  constexpr std::size_t kCount = 155, kRound = 126;  // 125.7 m
  Vector6d drift;
  drift << 0.004, 0.004, 0.008, 0, 1e-4, 5e-4;
  std::vector<SE3> poses{truth(path, 0)};
  for (std::size_t i = 1; i < kCount; ++i)
    poses.push_back(poses.back() * (truth(path, i - 1).inverse() * truth(path, i)) * se3_exp(drift));
  Odometry odometry = make_odometry(poses);
  const auto error_between_passes = [&](std::size_t i) {
    return distance_m(pose(odometry, i).inverse() * pose(odometry, i + kRound),
                      truth(path, i).inverse() * truth(path, i + kRound));
  };
  EXPECT_GT(error_between_passes(10), 1);
  const Drive drive = make_block().drive(path, kCount);
  for (const Loop& loop : find_loops(drive, {}, odometry))
    EXPECT_LT(distance_m(loop.earlier_from_later, truth(path, loop.earlier).inverse() * truth(path, loop.later)), 0.04)
        << loop.later;
  close_loops(drive, {}, odometry);
  EXPECT_GE(odometry.loops, 4);
  EXPECT_GT(odometry.largest_correction_m, 1);
  for (std::size_t i = 0; i < kCount - kRound; i += 4) EXPECT_LT(error_between_passes(i), 0.04) << i;
  for (std::size_t i = 0; i < kCount; i += 5) EXPECT_LT((pose(odometry, i).t - truth(path, i).t).norm(), 0.4) << i;
  EXPECT_EQ(pose(odometry, 0).t, truth(path, 0).t);
}

TEST(LoopClosure, ClosesTheLoopAfterAnErrorOfOdometry) {
  // Between scans 20 and 30 only the ground is visible, and the change of speed is not observable.
  const Trajectory path = make_circular_path(6.2, [](double s) { return s > 2 && s < 3 ? 22.5 : 25; });
  constexpr std::size_t kCount = 61;
  Drive drive = make_block().drive(path, kCount);
  const Lazy<Scan> clear = drive.scans;
  drive.scans = {kCount, kCount, [clear](std::size_t i) {
                   const Scan& all = *clear[i];
                   if (i < 20 || i >= 30) return all;
                   Scan ground;
                   for (std::size_t k = 0; k < all.points.size(); ++k)
                     if (all.points[k].z() < -1.7F) {
                       ground.points.push_back(all.points[k]);
                       ground.intensity.push_back(0);
                       ground.time.push_back(all.time[k]);
                       ground.ring.push_back(all.ring[k]);
                     }
                   return ground;
                 }};
  const Odometry found = estimate_odometry(drive, {});
  EXPECT_GE(found.loops, 1);
  EXPECT_GT(found.largest_correction_m, 1);
  const std::size_t last = kCount - 1;
  EXPECT_LT(distance_m(pose(found, last), truth(path, 0).inverse() * truth(path, last)), 0.1);
}

/// A drive through one street and then through another, which odometry places 2 m beside the first.
struct TwoStreets {
  static constexpr std::size_t kEach = 30;
  std::vector<SE3> truth, estimate;
  explicit TwoStreets(double y) {
    for (std::size_t i = 0; i < 2 * kEach; ++i) {
      const double x = 1.5 * static_cast<double>(i % kEach), aside = i < kEach ? 0 : 1;
      truth.push_back({Eigen::Matrix3d::Identity(), {x, aside * y, 1.8}});
      estimate.push_back({so3_exp({0, 0, 0.03 * aside}), {x + 1.5 * aside, 2 * aside, 1.8 + 0.4 * aside}});
    }
  }
  Drive drive(const TestStreet& world) const {
    Drive out = world.drive({}, static_cast<int>(truth.size()));
    out.scans = {truth.size(), truth.size(), [world, truth = truth](std::size_t i) {
                   // The car moves at 15 m/s.
                   std::vector<StampedPose> path;
                   for (const int k : {-1, 0, 1})
                     path.push_back({(static_cast<std::int64_t>(i) + k) * TestStreet::kScanPeriodNs,
                                     {truth[i].R, truth[i].t + Eigen::Vector3d(1.5 * k, 0, 0)}});
                   return world.scan(Trajectory(path), 0.1 * static_cast<double>(i));
                 }};
    return out;
  }
};

TEST(LoopClosure, FindsTheSameStreetDespiteAnErrorOfMeters) {
  TestStreet world = make_empty_world();
  add_street(world, 0, 9, 1);
  const TwoStreets streets(0);
  const std::vector<Loop> loops = find_loops(streets.drive(world), {}, make_odometry(streets.estimate));
  EXPECT_GE(loops.size(), 4);
  for (const Loop& loop : loops)
    EXPECT_LT(distance_m(loop.earlier_from_later, streets.truth[loop.earlier].inverse() * streets.truth[loop.later]), 0.05)
        << loop.later;
}

TEST(LoopClosure, DoesNotConfuseSimilarStreets) {
  for (const std::uint64_t seed : {2, 3}) {
    TestStreet world = make_empty_world();
    add_street(world, 0, 9, 1);
    add_street(world, 60, 9, seed);
    const TwoStreets streets(60);
    EXPECT_THAT(find_loops(streets.drive(world), {}, make_odometry(streets.estimate)), IsEmpty()) << seed;
  }
}

TEST(LoopClosure, FindsNoLoopInATunnel) {
  const TwoStreets streets(0);
  EXPECT_THAT(find_loops(streets.drive(TestStreet::tunnel()), {}, make_odometry(streets.estimate)), IsEmpty());
}

TEST(LoopClosure, DoesNotChangeADriveWithoutLoops) {
  const Drive drive = TestStreet().drive(TestStreet::path(15), 24);
  OdometryOptions without;
  without.loops = false;
  const Odometry a = estimate_odometry(drive, {}), b = estimate_odometry(drive, without);
  EXPECT_EQ(a.loops, 0);
  EXPECT_EQ(a.largest_correction_m, 0);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(pose(a, i).R, pose(b, i).R);
    EXPECT_EQ(pose(a, i).t, pose(b, i).t);
  }
}

TEST(LoopClosure, AcceptsAStationaryCarAndDrivesOfOneScanOrNone) {
  Odometry stationary = make_odometry(std::vector<SE3>(20));
  close_loops(TestStreet().drive(TestStreet::path(0), 20), {}, stationary);
  EXPECT_EQ(stationary.loops, 0);
  EXPECT_EQ(estimate_odometry(TestStreet().drive(TestStreet::path(0), 1), {}).loops, 0);
  Odometry none;
  close_loops({}, {}, none);
  EXPECT_EQ(none.loops, 0);
}

}  // namespace
}  // namespace dvi::odometry
