#include "dvi/inputs/near_target.h"

#include <gtest/gtest.h>

namespace dvi::inputs {
namespace {

/// A drive with poses and frames every second at the given x, on a hill whose height must not matter.
Drive drive_along(const std::vector<double>& xs, double y = 0) {
  Drive drive;
  std::vector<StampedPose> poses;
  for (std::size_t i = 0; i < xs.size(); ++i) {
    StampedPose pose{static_cast<std::int64_t>(i) * 1'000'000'000, SE3()};
    pose.world_from_body.t = {xs[i], y, 400};
    poses.push_back(pose);
    drive.frames.emplace_back().time_ns = pose.time_ns;
  }
  drive.poses = Trajectory(std::move(poses));
  return drive;
}

constexpr std::int64_t kSecondNs = 1'000'000'000;

TEST(NearTarget, ReturnsTheTimeFromTheFirstNearPoseToTheLast) {
  const Drive target = drive_along({0, 20, 40});
  const auto near = time_near_target(target, drive_along({-900, -145, 20, 2000, 100, 185, 400}));
  ASSERT_TRUE(near);
  EXPECT_EQ(near->first, 1 * kSecondNs);
  EXPECT_EQ(near->last, 5 * kSecondNs) << "the drive returns";
  EXPECT_FALSE(time_near_target(target, drive_along({0, 20, 40}, 230)));
  EXPECT_TRUE(time_near_target(target, drive_along({0, 20, 40}, -149)));
}

TEST(NearTarget, UsesThePosesOfTheTargetsFramesOnly) {
  Drive target = drive_along({0, 1000});
  target.frames.resize(1);
  EXPECT_FALSE(time_near_target(target, drive_along({1000})));
  EXPECT_TRUE(time_near_target(target, drive_along({10})));
}

TEST(NearTarget, TransformsPositionsToTheTargetsScale) {
  const Drive target = drive_along({1000});
  Drive source = drive_along({2000});
  EXPECT_FALSE(time_near_target(target, source));
  source.world_scale = 2;
  EXPECT_TRUE(time_near_target(target, source));
}

}  // namespace
}  // namespace dvi::inputs
