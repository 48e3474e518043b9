#include "dvi/inputs/choose_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/test_rgbd.h"

namespace dvi::inputs {
namespace {

/// A recording of a depth camera that shows a room in its first images and a white wall from then on.
Drive drive_to_white_wall(std::size_t images_of_room) {
  TestRgbd test{[](double s) { return SE3{so3_exp({0, 0.1, 0.3 * s}), {0, 0, 1.3}}; }};
  test.count = 24;
  test.blank = [=](std::size_t i) { return i >= images_of_room; };
  return test.drive();
}

PoseChoice choose(const Drive& drive, job::PosesFrom::Kind kind) {
  Progress progress(ProgressStyle::quiet);
  job::PosesFrom wish;
  wish.kind = kind;
  return choose_poses(drive, wish, {}, progress);
}

TEST(ChoosePoses, RefusesARecordingOfADepthCameraThatIsMostlyLost) {
  const Drive drive = drive_to_white_wall(8);
  for (const job::PosesFrom::Kind kind : {job::PosesFrom::Kind::loam, job::PosesFrom::Kind::automatic}) try {
      choose(drive, kind);
      ADD_FAILURE() << "an error was expected";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("16 of 24 depth images could not be aligned"));
      EXPECT_THAT(error.what(), testing::HasSubstr("--poses FILE"));
    }
}

TEST(ChoosePoses, WarnsOfAPartInWhichADepthCameraIsLost) {
  const Drive drive = drive_to_white_wall(18);
  const PoseChoice choice = choose(drive, job::PosesFrom::Kind::loam);
  EXPECT_EQ(choice.from, PoseOrigin::loam);
  EXPECT_THAT(choice.warnings, testing::Contains(testing::HasSubstr("6 of 24 depth images could not be aligned")));
  EXPECT_TRUE(trajectory_of(drive, choice).at(drive.frames[17].time_ns));
  EXPECT_FALSE(trajectory_of(drive, choice).at(drive.frames[18].time_ns));
}

TEST(ChoosePoses, KeepsGivenPosesOfADepthCameraThatIsMostlyLost) {
  Drive drive = drive_to_white_wall(8);
  std::vector<StampedPose> given;
  for (const Frame& frame : drive.frames)
    given.push_back(
        {frame.time_ns, SE3{so3_exp({0, 0, 1e-8 * static_cast<double>(frame.time_ns) * 0.03}), Eigen::Vector3d::Zero()}});
  drive.poses = Trajectory(given);
  EXPECT_EQ(choose(drive, job::PosesFrom::Kind::automatic).from, PoseOrigin::given);
}

TEST(ChoosePoses, EstimatesPosesIfGivenPosesCoverOtherTimes) {
  Drive drive = drive_to_white_wall(24);
  constexpr std::int64_t kLaterNs = 1'000'000'000'000;
  drive.poses = Trajectory({{drive.frames.front().time_ns + kLaterNs, SE3{}}, {drive.frames.back().time_ns + kLaterNs, SE3{}}});
  EXPECT_EQ(choose(drive, job::PosesFrom::Kind::automatic).from, PoseOrigin::loam);
}

}  // namespace
}  // namespace dvi::inputs
