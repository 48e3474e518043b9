#include "dvi/datasets/pose_jumps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Makes a drive at 10 m/s with 10 poses per second.
std::vector<StampedPose> straight_poses(std::size_t count) {
  std::vector<StampedPose> poses(count);
  for (std::size_t i = 0; i < count; ++i) {
    poses[i].time_ns = static_cast<std::int64_t>(i) * 100'000'000;
    poses[i].world_from_body.t = {static_cast<double>(i), 0, 0};
  }
  return poses;
}

Drive posed_drive(const std::vector<StampedPose>& poses) {
  Drive drive;
  for (std::size_t i = 0; i < poses.size(); ++i) drive.frames.push_back({static_cast<int>(i), "", poses[i].time_ns, {}, {}});
  drive.poses = Trajectory(poses);
  return drive;
}

TEST(PoseJumps, OfFarPosesAreRemovedAtAnyIndex) {
  for (const std::size_t far : {0, 4, 9}) {
    std::vector<StampedPose> poses = straight_poses(10);
    poses[far].world_from_body.t.x() = 4'189'970;
    Drive drive = posed_drive(poses);
    leave_out_pose_jumps(drive);
    EXPECT_EQ(drive.poses.poses().size(), 9U);
    for (const StampedPose& pose : drive.poses.poses()) EXPECT_LT(pose.world_from_body.t.x(), 10);
    EXPECT_THAT(drive.warnings, ElementsAre(AllOf(HasSubstr("1 of 10 given poses are outliers"), HasSubstr("near frame"))));
    if (far == 4) {
      EXPECT_NEAR(drive.poses.at(400'000'000)->t.x(), 4, 1e-9) << "interpolated";
    }
  }
}

TEST(PoseJumps, AreNotFoundInGapsFastDrivesAndNoise) {
  std::vector<StampedPose> poses = straight_poses(10);
  poses[3].world_from_body.t.y() = 3;
  for (std::size_t i = 5; i < 10; ++i) poses[i].time_ns += 60'000'000'000, poses[i].world_from_body.t.x() += 1500;
  Drive drive = posed_drive(poses);
  leave_out_pose_jumps(drive);
  EXPECT_EQ(drive.poses.poses().size(), 10U);
  EXPECT_TRUE(drive.warnings.empty());
}

TEST(PoseJumps, OfACorrectionAreReportedAndBothSidesKept) {
  std::vector<StampedPose> poses = straight_poses(10);
  for (std::size_t i = 5; i < 10; ++i) poses[i].world_from_body.t.y() = 30;
  Drive drive = posed_drive(poses);
  leave_out_pose_jumps(drive);
  EXPECT_EQ(drive.poses.poses().size(), 10U);
  EXPECT_THAT(drive.warnings, ElementsAre(HasSubstr("the given poses jump by 30 m within 0.10 s")));
}

TEST(PoseJumps, BetweenTwoFarPartsKeepTheLargerOne) {
  std::vector<StampedPose> poses = straight_poses(10);
  for (std::size_t i = 0; i < 4; ++i) poses[i].world_from_body.t.y() = 5000;
  Drive drive = posed_drive(poses);
  leave_out_pose_jumps(drive);
  EXPECT_EQ(drive.poses.poses().size(), 6U);
}

}  // namespace
}  // namespace dvi::datasets
