#include "dvi/odometry/motion_prior.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/odometry/odometry.h"
#include "dvi/testing/test_street.h"

namespace dvi::odometry {

namespace {

constexpr std::int64_t kScanPeriod = TestStreet::kScanPeriodNs;

/// The poses of a path at the scans, each changed by `change(i, pose)`.
template <class Change>
Trajectory change_poses(const Trajectory& path, int count, const Change& change) {
  std::vector<StampedPose> poses;
  for (int i = -3; i < count + 3; ++i) {
    SE3 pose = *path.at(i * kScanPeriod);
    change(i, pose);
    poses.push_back({i * kScanPeriod, pose});
  }
  return Trajectory(poses);
}

Trajectory add_jump(const Trajectory& path, int count, int at) {
  return change_poses(path, count, [&](int i, SE3& pose) { pose.t.x() += i == at ? 5 : 0; });
}

TEST(MotionPrior, ReturnsTheMotionExceptAtJumps) {
  const Trajectory path = TestStreet::path(10, 0.3);
  const MotionPrior prior(add_jump(path, 12, 6));
  for (int i = 0; i + 1 < 12; ++i) {
    const std::optional<SE3> motion = prior.motion(i * kScanPeriod, (i + 1) * kScanPeriod);
    ASSERT_EQ(motion.has_value(), i != 5 && i != 6) << i;
    if (!motion) continue;
    EXPECT_LT((motion->t - (path.at(i * kScanPeriod)->inverse() * *path.at((i + 1) * kScanPeriod)).t).norm(), 1e-6);
  }
  EXPECT_FALSE(prior.motion(1000 * kScanPeriod, 1001 * kScanPeriod));
  EXPECT_FALSE(MotionPrior().motion(0, kScanPeriod));
  EXPECT_FALSE(MotionPrior(Trajectory(std::vector<StampedPose>{{0, SE3()}})).motion(900 * kScanPeriod, 901 * kScanPeriod));
}

TEST(GivenMotion, DecidesInATunnel) {
  const Trajectory path = TestStreet::path(6, 0, 4);  // accelerates, so that constant velocity is wrong
  const Drive drive = TestStreet::tunnel().drive(path, 15);
  const Odometry found = estimate_odometry(drive, {}, path);
  EXPECT_LT(worst_error(found.world_from_lidar, path), 0.1);
  for (std::size_t i = 1; i < 15; ++i) {
    EXPECT_TRUE(found.scans[i].given) << i;
    EXPECT_EQ(found.scans[i].degenerate, 1) << i;
  }
  EXPECT_GT(worst_error(estimate_odometry(drive, {}).world_from_lidar, path), 1);
}

TEST(GivenMotion, IsIgnoredAtAJump) {
  const Trajectory path = TestStreet::path(10);
  const Odometry found = estimate_odometry(TestStreet::tunnel().drive(path, 15), {}, add_jump(path, 15, 8));
  EXPECT_FALSE(found.scans[8].given);
  EXPECT_FALSE(found.scans[9].given);
  EXPECT_TRUE(found.scans[10].given);
  EXPECT_LT(worst_error(found.world_from_lidar, path), 0.3);
}

TEST(GivenMotion, IsIgnoredIfWrongWhereTheSceneConstrainsThePose) {
  const Trajectory path = TestStreet::path(11, 0.15, 2);
  const Drive drive = TestStreet().drive(path, 15);
  const double alone = worst_error(estimate_odometry(drive, {}).world_from_lidar, path);
  const auto error = [&](const Trajectory& given) {
    return worst_error(estimate_odometry(drive, {}, given).world_from_lidar, path);
  };
  Random random(3);
  EXPECT_LT(error(path), alone + 0.01);
  EXPECT_LT(error(add_jump(path, 15, 5)), alone + 0.01);
  EXPECT_LT(error(change_poses(path, 15, [](int, SE3& pose) { pose.R = pose.R * so3_exp({0, 0, 1.6}); })), alone + 0.01)
      << "turned";
  EXPECT_LT(error(change_poses(path, 15, [](int, SE3& pose) { pose = {}; })), alone + 0.01) << "frozen";
  const auto shake = [&](int, SE3& pose) { pose.t += 3 * Eigen::Vector3d(random.normal(), random.normal(), random.normal()); };
  EXPECT_LT(error(change_poses(path, 15, shake)), alone + 0.01) << "garbage";
}

}  // namespace
}  // namespace dvi::odometry
