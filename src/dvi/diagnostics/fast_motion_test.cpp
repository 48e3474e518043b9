#include "dvi/diagnostics/fast_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi::diagnostics {
namespace {

Drive handheld() {
  Drive drive;
  drive.sensor = Sensor::depth_camera;
  drive.camera = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240};
  for (int i = 0; i < 4; ++i) drive.frames.push_back({i, std::to_string(i), i * 100'000'000, {}, {}});
  return drive;
}

// Turns about an axis at a rate from the third frame on.
Trajectory turning_from_second(double radians_a_second) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 8; ++i)
    poses.push_back(
        {i * 50'000'000, {so3_exp(Eigen::Vector3d(0, 0, radians_a_second * 0.05 * std::max(0, i - 3))), {0, 0, 0}}});
  return Trajectory(poses);
}

TEST(FastMotion, NamesTheFramesAndTheBend) {
  EXPECT_THAT(fast_motion(handheld(), turning_from_second(2)),
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("up to 30 px"), testing::HasSubstr("frames 2-3"))));
}

TEST(FastMotion, SaysNothingOfACalmHandOrOfALidar) {
  EXPECT_TRUE(fast_motion(handheld(), turning_from_second(0.3)).empty());
  Drive lidar = handheld();
  lidar.sensor = Sensor::lidar;
  EXPECT_TRUE(fast_motion(lidar, turning_from_second(2)).empty());
}

}  // namespace
}  // namespace dvi::diagnostics
