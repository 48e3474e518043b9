#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/odometry/loop_closure.h"
#include "dvi/odometry/odometry.h"
#include "dvi/scan_match/scan_features.h"
#include "dvi/testing/test_room.h"

namespace dvi::odometry {

namespace {

constexpr std::int64_t kPeriodNs = 33'333'333;

/// A hand that moves sideways and rotates the camera.
SE3 hand(int i) {
  const double s = 0.05 * i;
  return {so3_exp({0.03 * std::sin(s), 0.4 + 0.1 * std::sin(1.3 * s), 0.3 * std::sin(s)}), {0.1 * s, 0.4 * std::sin(s), 1.4}};
}

TEST(Odometry, FollowsADepthCameraThroughARoom) {
  Drive drive;
  drive.sensor = Sensor::depth_camera;
  for (int i = 0; i < 40; ++i)
    drive.scan_headers.push_back({std::to_string(i), i * kPeriodNs, i * kPeriodNs, i * kPeriodNs, {}});
  drive.scans =
      Lazy<Scan>(drive.scan_headers.size(), [](std::size_t i) { return TestRoom().scan(hand(static_cast<int>(i)), i + 1); });
  const Odometry found = estimate_odometry(drive, {});
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  ASSERT_EQ(found.world_from_lidar.poses().size(), 40U);
  for (int i = 0; i < 40; ++i) {
    const SE3 off =
        found.world_from_lidar.poses()[static_cast<std::size_t>(i)].world_from_body.inverse() * hand(0).inverse() * hand(i);
    EXPECT_LT(off.t.norm(), 0.01) << i;
    EXPECT_LT(so3_log(off.R).norm(), 0.005) << i;
  }
}

/// A drive of a depth camera with poses `truth`, in the room with that index.
Drive make_room_drive(const std::vector<SE3>& truth, const std::vector<TestRoom>& rooms, const std::vector<std::size_t>& room) {
  Drive drive;
  drive.sensor = Sensor::depth_camera;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto time = static_cast<std::int64_t>(i) * kPeriodNs;
    drive.scan_headers.push_back({std::to_string(i), time, time, time, {}});
  }
  drive.scans = {truth.size(), truth.size(), [=](std::size_t i) { return rooms[room[i]].scan(truth[i], i + 1); }};
  return drive;
}

/// The result of odometry with these poses.
Odometry make_room_odometry(const std::vector<SE3>& poses) {
  Odometry out;
  std::vector<StampedPose> stamped;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    stamped.push_back({static_cast<std::int64_t>(i) * kPeriodNs, poses[i]});
    out.scans.emplace_back();
    out.scans.back().information = 1e6 * Matrix6d::Identity();
  }
  out.world_from_lidar = Trajectory(stamped);
  return out;
}

const SE3& pose_of(const Odometry& odometry, std::size_t i) { return odometry.world_from_lidar.poses()[i].world_from_body; }

TestRoom make_large_room(std::uint64_t seed) {
  TestRoom room;
  room.walls = {{-2, -2.5, 0}, {4, 2.5, 2.5}};
  room.furnish(seed);
  return room;
}

TEST(LoopClosure, ClosesAHandheldLoopInARoom) {
  // 6.3 m around the middle of the room, looking across it, and a quarter more.
  constexpr std::size_t kRound = 80, kCount = 100;
  std::vector<SE3> truth, estimate;
  Vector6d drift;
  drift << 0.002, 0.001, 0.001, 2e-4, -2e-4, 4e-4;
  for (std::size_t i = 0; i < kCount; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kRound, nod = 0.05 * std::sin(1.7 * angle);
    truth.push_back({so3_exp({0, 0, angle + std::numbers::pi}) * so3_exp({0.03, 0.15 + nod, 0}),
                     {1 + std::cos(angle), std::sin(angle), 1.4 + 0.05 * std::sin(3 * angle)}});
    estimate.push_back(i == 0 ? truth[0] : estimate.back() * (truth[i - 1].inverse() * truth[i]) * se3_exp(drift));
  }
  Odometry odometry = make_room_odometry(estimate);
  const auto error_between_passes = [&](std::size_t i) {
    return ((pose_of(odometry, i).inverse() * pose_of(odometry, i + kRound)).inverse() *
            (truth[i].inverse() * truth[i + kRound]))
        .t.norm();
  };
  EXPECT_GT(error_between_passes(10), 0.07);
  const Drive drive = make_room_drive(truth, {make_large_room(1)}, std::vector<std::size_t>(kCount, 0));
  const OdometryOptions options = adapt_to_sensor(drive, {});
  const std::vector<Loop> loops = find_loops(drive, options, odometry);
  for (const Loop& loop : loops)
    EXPECT_LT((loop.earlier_from_later.inverse() * (truth[loop.earlier].inverse() * truth[loop.later])).t.norm(), 0.015)
        << loop.later;
  close_loops(drive, options, odometry);
  EXPECT_GE(odometry.loops, 1);
  for (std::size_t i = 0; i < kCount - kRound; i += 4) EXPECT_LT(error_between_passes(i), 0.02) << i;
}

TEST(LoopClosure, DoesNotConfuseSimilarRooms) {
  // Through one room and then through another with the same walls, which odometry places 20 cm beside the first.
  constexpr std::size_t kEach = 24;
  for (const std::uint64_t seed : {1, 2, 3}) {
    std::vector<SE3> truth, estimate;
    std::vector<std::size_t> room;
    for (std::size_t i = 0; i < 2 * kEach; ++i) {
      const double y = 0.15 * static_cast<double>(i % kEach) - 1.8, aside = i < kEach ? 0 : 1;
      truth.push_back({so3_exp({0, 0.15, -0.2 * y}), {-1.3, y, 1.4}});
      estimate.push_back({so3_exp({0, 0, 0.03 * aside}) * truth[i].R, truth[i].t + aside * Eigen::Vector3d(0.15, 0.1, 0.05)});
      room.push_back(i < kEach ? 0 : 1);
    }
    const Drive drive = make_room_drive(truth, {make_large_room(1), make_large_room(seed)}, room);
    const std::vector<Loop> loops = find_loops(drive, adapt_to_sensor(drive, {}), make_room_odometry(estimate));
    EXPECT_EQ(loops.empty(), seed != 1) << seed;
  }
}

TEST(ForSensor, HasRangeAndLengthsOfRoomsForADepthCamera) {
  Drive drive;
  const OdometryOptions options;
  EXPECT_EQ(scan_match::adapt_to_sensor(options, drive).max_range_m, 120);
  EXPECT_EQ(scan_match::adapt_to_sensor(options, drive).voxel_m, options.voxel_m);
  drive.sensor = Sensor::depth_camera;
  EXPECT_EQ(scan_match::adapt_to_sensor(options, drive).max_range_m, 10);
  EXPECT_LT(scan_match::adapt_to_sensor(options, drive).voxel_m, options.voxel_m);
  OdometryOptions given;
  given.max_range_m = 4;
  EXPECT_EQ(scan_match::adapt_to_sensor(given, drive).max_range_m, 4);
}

}  // namespace
}  // namespace dvi::odometry
