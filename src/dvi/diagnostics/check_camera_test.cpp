#include "dvi/diagnostics/check_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dvi/diagnostics/test_drive.h"
#include "dvi/geometry/angles.h"

namespace dvi::diagnostics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> check(const Drive& drive) {
  return check_camera(make_flow_pairs(drive, make_true_tracks(drive), drive.masks), drive.camera_from_lidar);
}

Drive rotate_camera(Drive drive, const Eigen::Vector3d& degrees) {
  drive.camera_from_lidar.R = so3_exp(to_radians(1) * degrees) * drive.camera_from_lidar.R;
  return drive;
}

Drive delay_images(Drive drive, double seconds) {
  for (Frame& frame : drive.frames) frame.time_ns += std::llround(1e9 * seconds);
  return drive;
}

/// Replaces the LiDAR by depth images: in camera axes, without motion within a scan.
Drive replace_lidar_by_depth(Drive drive, const std::shared_ptr<const synth::Scene>& scene) {
  std::vector<StampedPose> poses = drive.poses.poses();
  for (StampedPose& p : poses) p.world_from_body = p.world_from_body * drive.camera_from_lidar.inverse();
  drive.poses = Trajectory(poses);
  drive.camera_from_lidar = SE3();
  drive.scans = Lazy<Scan>(drive.frames.size(), [scene](std::size_t i) {
    const cv::Mat1f depth = scene->render(static_cast<int>(i)).depth;
    Scan scan;
    for (int y = 0; y < depth.rows; y += 2)
      for (int x = 0; x < depth.cols; x += 2)
        if (depth(y, x) > 0 && depth(y, x) < 30)
          scan.points.push_back((depth(y, x) * scene->camera().ray({x, y})).cast<float>());
    scan.time.assign(scan.size(), 0);
    scan.intensity.assign(scan.size(), 0);
    return scan;
  });
  return drive;
}

TEST(CheckCamera, AcceptsCorrectSetups) {
  EXPECT_THAT(check(make_test_drive(1, 0)), IsEmpty());
  EXPECT_THAT(check(make_test_drive(2, 40)), IsEmpty());
  EXPECT_THAT(check(make_test_drive(3, -30, 12)), IsEmpty());
}

TEST(CheckCamera, ReportsARotationWithItsAxis) {
  const Drive straight = make_test_drive(1, 0), curve = make_test_drive(2, 40);
  for (const Drive& drive : {straight, curve}) {
    EXPECT_THAT(check(rotate_camera(drive, {2, 0, 0})), ElementsAre(HasSubstr("degrees about its horizontal axis")));
    EXPECT_THAT(check(rotate_camera(drive, {0, 5, 0})), ElementsAre(HasSubstr("degrees about the vertical")));
    EXPECT_THAT(check(rotate_camera(drive, {0, 0, 5})), ElementsAre(HasSubstr("degrees about its optical axis")));
  }
}

TEST(CheckCamera, ReportsADelayOfTheImages) {
  for (const Drive& drive : {make_test_drive(1, 0), make_test_drive(2, 40)}) {
    EXPECT_THAT(check(delay_images(drive, 0.1)), ElementsAre(HasSubstr("seem to be late by about 0.")));
    EXPECT_THAT(check(delay_images(drive, -0.4)), ElementsAre(HasSubstr("seem to be early by about 0.")));
  }
}

TEST(CheckCamera, ReportsAnInvertedMountingAndAnotherResolution) {
  Drive drive = make_test_drive(1, 0);
  const SE3 right = drive.camera_from_lidar;
  drive.camera_from_lidar = right.inverse();
  EXPECT_THAT(check(drive), ElementsAre(HasSubstr("inverted")));
  drive.camera_from_lidar = {so3_exp({0, std::numbers::pi, 0}) * right.R, {0, -100, 0}};
  EXPECT_THAT(check(drive), ElementsAre(HasSubstr("almost no returns")));
  drive.camera_from_lidar = right;
  const Camera camera = drive.camera;
  for (const double factor : {0.5, 0.75, 1.7}) {
    drive.camera = camera;
    for (double* value : {&drive.camera.fx, &drive.camera.fy, &drive.camera.cx, &drive.camera.cy}) *value *= factor;
    const std::vector<std::string> found = check(drive);
    ASSERT_THAT(found, ElementsAre(HasSubstr("times as wide")));
    EXPECT_NEAR(std::stod(found.front().substr(found.front().find("images ") + 7)), factor, 0.03 * factor);
  }
}

TEST(CheckCamera, ReportsNothingWithoutMotionOrTexture) {
  EXPECT_THAT(check(rotate_camera(make_test_drive(1, 0, 0), {0, 5, 0})), IsEmpty()) << "stationary";
  Drive dark = rotate_camera(make_test_drive(1, 0), {0, 5, 0});
  dark.images = Lazy<cv::Mat3b>(dark.frames.size(), [](std::size_t) { return cv::Mat3b(360, 640, cv::Vec3b(9, 9, 9)); });
  EXPECT_THAT(check(dark), IsEmpty()) << "no texture";
  Drive one = make_test_drive(1, 0);
  one.scan_headers.resize(1), one.frames.resize(1);
  EXPECT_THAT(check(one), IsEmpty()) << "one scan";
}

TEST(CheckCamera, WorksForADepthCamera) {
  synth::SynthOptions options;
  options.frames = 14, options.width = 640, options.height = 360;
  const auto scene = std::make_shared<synth::Scene>(options);
  const Drive drive = replace_lidar_by_depth(synth::drive_of(scene), scene);
  EXPECT_THAT(check(drive), IsEmpty());
  EXPECT_THAT(check(rotate_camera(drive, {0, 5, 0})), ElementsAre(HasSubstr("about the vertical")));
}

}  // namespace
}  // namespace dvi::diagnostics
