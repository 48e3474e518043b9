#include "dvi/diagnostics/fast_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi::diagnostics {
namespace {

Drive make_handheld() {
  Drive drive;
  drive.sensor = Sensor::depth_camera;
  drive.camera = {.width = 640, .height = 480, .fx = 500, .fy = 500, .cx = 320, .cy = 240};
  for (int i = 0; i < 4; ++i) drive.frames.push_back({i, std::to_string(i), i * 100'000'000, {}, {}});
  return drive;
}

/// A trajectory that rotates about an axis from the third frame on.
Trajectory rotate_from_third_frame(double turn_rad_s) {
  std::vector<StampedPose> poses;
  for (int i = 0; i < 8; ++i)
    poses.push_back({i * 50'000'000, {so3_exp(Eigen::Vector3d(0, 0, turn_rad_s * 0.05 * std::max(0, i - 3))), {0, 0, 0}}});
  return Trajectory(poses);
}

TEST(FastMotion, ReportsTheFramesAndTheSkew) {
  EXPECT_THAT(check_fast_motion(make_handheld(), rotate_from_third_frame(2)),
              testing::ElementsAre(testing::AllOf(testing::HasSubstr("up to 30 px"), testing::HasSubstr("frames 2-3"))));
}

TEST(FastMotion, ReportsNothingForASlowHandOrALidar) {
  EXPECT_TRUE(check_fast_motion(make_handheld(), rotate_from_third_frame(0.3)).empty());
  Drive lidar = make_handheld();
  lidar.sensor = Sensor::lidar;
  EXPECT_TRUE(check_fast_motion(lidar, rotate_from_third_frame(2)).empty());
}

}  // namespace
}  // namespace dvi::diagnostics
