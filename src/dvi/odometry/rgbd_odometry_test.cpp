#include "dvi/odometry/rgbd_odometry.h"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/datasets/reader.h"
#include "dvi/geometry/angles.h"
#include "dvi/odometry/direct_alignment.h"
#include "dvi/odometry/rgbd_result.h"
#include "dvi/odometry/thumbnail.h"
#include "dvi/testing/find_recording.h"
#include "dvi/testing/test_rgbd.h"

namespace dvi::odometry {
namespace {

/// A hand that rotates the camera by up to 4 degrees per image, about all axes.
SE3 rotate_fast(double s) {
  return {so3_exp({0, 0, 0.5 * std::sin(3.5 * s)}) * so3_exp({0.25 * std::sin(4 * s), 0.1 + 0.25 * std::sin(3 * s), 0}),
          {0.03 * std::sin(2 * s), 0.03 * std::sin(3 * s), 1.3}};
}

struct Errors {
  double position_m = 0, rotation_deg = 0;  ///< the largest
  std::size_t posed = 0;
};

Errors measure_errors(const TestRgbd& test, const Odometry& found) {
  Errors out;
  for (std::size_t i = 0; i < test.count; ++i) {
    const auto time = static_cast<std::int64_t>(i) * TestRgbd::kPeriodNs;
    const std::optional<SE3> pose = found.world_from_lidar.at(time);
    if (!pose) continue;
    const SE3 truth = test.world_from_lidar(0).inverse() * test.world_from_lidar(1e-9 * static_cast<double>(time));
    const SE3 off = truth.inverse() * *pose;
    out.position_m = std::max(out.position_m, off.t.norm());
    out.rotation_deg = std::max(out.rotation_deg, to_degrees(so3_log(off.R).norm()));
    ++out.posed;
  }
  return out;
}

TEST(RgbdOdometry, FollowsFastRotations) {
  const TestRgbd test{rotate_fast};
  const Odometry found = estimate_odometry(test.drive(), {});
  const Errors errors = measure_errors(test, found);
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  EXPECT_EQ(errors.posed, test.count);
  EXPECT_LT(errors.position_m, 0.01);
  EXPECT_LT(errors.rotation_deg, 0.3);
}

TEST(RgbdOdometry, FollowsWhileTheExposureChanges) {
  TestRgbd test{rotate_fast};
  test.count = 25;
  test.exposure = [](double s) { return 1 + 0.3 * std::sin(8 * s); };
  const Errors errors = measure_errors(test, estimate_odometry(test.drive(), {}));
  EXPECT_EQ(errors.posed, test.count);
  EXPECT_LT(errors.position_m, 0.01);
}

TEST(RgbdOdometry, CorrectsTheDelayOfColorImages) {
  TestRgbd test{rotate_fast};
  test.color_delay_s = 0.015;  // during which the camera turns by up to 1.8 degrees
  const Drive drive = test.drive();
  const Odometry found = estimate_odometry(drive, {});
  const Errors errors = measure_errors(test, found);
  EXPECT_EQ(errors.posed, test.count);
  EXPECT_LT(errors.position_m, 0.015);
  EXPECT_LT(errors.rotation_deg, 0.4);
  const Frame& frame = drive.frames[20];
  const SE3 off = (test.world_from_lidar(0).inverse() * test.world_from_lidar(to_seconds(frame.time_ns))).inverse() *
                  found.world_from_lidar.at(frame.time_ns).value();
  EXPECT_LT(to_degrees(so3_log(off.R).norm()), 0.4) << "the pose at the time of the color image";
}

TEST(RgbdOdometry, HasNoPoseInFrontOfAWhiteWallAndRecovers) {
  TestRgbd test{rotate_fast};
  test.count = 50;
  test.blank = [](std::size_t i) { return i >= 15 && i < 35; };  // long enough for a new map, which holds nothing
  const Drive drive = test.drive();
  const Odometry found = estimate_odometry(drive, {});
  EXPECT_THAT(found.warnings, testing::ElementsAre(testing::HasSubstr("20 of 50 depth images could not be aligned")));
  for (std::size_t i = 0; i < test.count; ++i) {
    EXPECT_EQ(found.scans[i].state == ScanFit::State::lost, test.blank(i)) << i;
    EXPECT_EQ(found.world_from_lidar.at(drive.frames[i].time_ns).has_value(), !test.blank(i)) << i;
  }
  EXPECT_LT(measure_errors(test, found).position_m, 0.01);
}

TEST(RgbdOdometry, RecoversAfterOneSecondWithoutImages) {
  // The camera continues to rotate in the meantime, and returns.
  TestRgbd test{[](double s) {
    const double t = s < 0.5 ? s : s + 1;
    return SE3{so3_exp({0, 0, 0.4 * std::sin(2 * t)}) * so3_exp({0, 0.1, 0}), {0.05 * t, 0.02 * t, 1.3}};
  }};
  test.count = 30;
  Drive drive = test.drive();
  for (std::size_t i = 15; i < 30; ++i) {
    drive.frames[i].time_ns += 1'000'000'000;
    drive.scan_headers[i].time_ns += 1'000'000'000;
  }
  const Odometry found = estimate_odometry(drive, {});
  for (std::size_t i = 0; i < 30; ++i) {
    const std::optional<SE3> pose = found.world_from_lidar.at(drive.scan_headers[i].time_ns);
    ASSERT_TRUE(pose) << i;
    const double s = 1e-9 * static_cast<double>(TestRgbd::kPeriodNs) * static_cast<double>(i);
    EXPECT_LT(((test.world_from_lidar(0).inverse() * test.world_from_lidar(s)).inverse() * *pose).t.norm(), 0.015) << i;
  }
  EXPECT_FALSE(found.world_from_lidar.at(drive.scan_headers[14].time_ns + 500'000'000)) << "nothing is known in between";
}

TEST(RgbdOdometry, HasPosesInOneRoomOnlyIfRoomsAreNotConnected) {
  // After 30 images, the camera is in another room of which nothing leads back.
  TestRgbd first{rotate_fast}, second{rotate_fast};
  second.room.furnish(9);
  second.room.walls = {{-1.2, -1.5, 0}, {2.2, 2.2, 2.3}};
  const Drive one = first.drive(), other = second.drive();
  Drive drive = one;
  const auto is_other = [](std::size_t i) { return i >= 26; };
  drive.scans = Lazy<Scan>::through(40, [=](std::size_t i) { return is_other(i) ? other.scans[i] : one.scans[i]; });
  drive.images = Lazy<cv::Mat3b>::through(40, [=](std::size_t i) { return is_other(i) ? other.images[i] : one.images[i]; });
  const Odometry found = estimate_odometry(drive, {});
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(found.scans[i].state == ScanFit::State::lost, is_other(i)) << i;
}

TEST(ExcludeTimes, HasNoPoseAtExcludedTimes) {
  std::vector<StampedPose> poses;
  for (const std::int64_t ms : {0, 10, 33, 43, 100, 110, 133}) poses.push_back({1'000'000 * ms, SE3()});
  const Trajectory found = exclude_times(poses, {-33'000'000, 67'000'000, 167'000'000});
  for (const std::int64_t ms : {0, 20, 33, 105, 120, 133, 150}) EXPECT_TRUE(found.at(1'000'000 * ms)) << ms;
  for (const std::int64_t ms : {-33, 50, 67, 99, 167}) EXPECT_FALSE(found.at(1'000'000 * ms)) << ms;
}

TEST(DirectAlignment, FindsPoseAndBrightness) {
  TestRgbd test{[](double s) {
    return s < 0.01 ? SE3{so3_exp({0, 0.1, 0}), {0, 0, 1.3}} : SE3{so3_exp({0.05, 0.06, 0.08}), {0.04, -0.05, 1.33}};
  }};
  test.count = 2;
  test.exposure = [](double s) { return s < 0.01 ? 1.0 : 0.7; };
  const Drive drive = test.drive();
  const std::vector<RgbdMoment> moments = pair_depth_with_color(drive);
  const Vector6d still = Vector6d::Zero();
  const Alignment found =
      align(ReferenceView(read_rgbd_image(drive, moments[0], still)), read_rgbd_image(drive, moments[1], still), SE3());
  const SE3 camera_from_lidar = drive.camera_from_lidar;
  const SE3 truth =
      camera_from_lidar * test.world_from_lidar(0).inverse() * test.world_from_lidar(0.033) * camera_from_lidar.inverse();
  const SE3 off = truth.inverse() * found.reference_from_current;
  EXPECT_LT(off.t.norm(), 0.004);
  EXPECT_LT(to_degrees(so3_log(off.R).norm()), 0.1);
  EXPECT_NEAR(found.gain, 0.7, 0.03);
  EXPECT_GT(found.inlier_share(), 0.9);
  EXPECT_GT(found.correlation, 0.95);
}

TEST(Thumbnails, ShowTheRotationOfTheCamera) {
  TestRgbd test{[](double s) {
    return SE3{s < 0.01 ? so3_exp({0, 0.1, 0}) : so3_exp({0, 0.1, 0}) * so3_exp({to_radians(8), to_radians(4), to_radians(12)}),
               {0, 0, 1.3}};
  }};
  test.count = 2;
  const Drive drive = test.drive();
  const std::vector<RgbdMoment> moments = pair_depth_with_color(drive);
  const auto thumbnail = [&](std::size_t i) { return make_thumbnail(read_rgbd_image(drive, moments[i], Vector6d::Zero())); };
  const ThumbnailMatch found = match(thumbnail(0), thumbnail(1), 16);
  const Eigen::Matrix3d R = drive.camera_from_lidar.R;
  const Eigen::Matrix3d truth = R * test.world_from_lidar(0).R.transpose() * test.world_from_lidar(0.033).R * R.transpose();
  EXPECT_GT(found.correlation, 0.8);
  EXPECT_LT(to_degrees(so3_log(truth.transpose() * found.a_from_b).norm()), 3);
}

TEST(RgbdMoments, PairDepthImagesWithTheNearestColorImages) {
  TestRgbd test{rotate_fast};
  test.count = 4;
  Drive drive = test.drive();
  drive.frames[1].time_ns += 10'000'000;
  drive.frames[2].time_ns -= 12'000'000;
  drive.frames.erase(drive.frames.begin() + 3);
  const std::vector<RgbdMoment> moments = pair_depth_with_color(drive);
  ASSERT_EQ(moments.size(), 4U);
  EXPECT_EQ(moments[0].frame, 0U);
  EXPECT_EQ(moments[1].frame, 1U);
  EXPECT_EQ(moments[1].time_ns, drive.frames[1].time_ns);
  EXPECT_NEAR(moments[1].depth_delay_s, -0.01, 1e-9);
  EXPECT_EQ(moments[2].frame, 2U);
  EXPECT_FALSE(moments[3].frame);
  EXPECT_EQ(moments[3].time_ns, drive.scan_headers[3].time_ns);
}

/// RMS distance of positions at the depth images after the best rigid fit.
double absolute_trajectory_error_m(const Drive& drive, const Trajectory& found) {
  std::vector<Eigen::Vector3d> a, b;
  for (const ScanHeader& header : drive.scan_headers)
    if (const auto pose = found.at(header.time_ns), given = drive.poses.at(header.time_ns); pose && given)
      a.push_back(pose->t), b.push_back(given->t);
  const Eigen::Map<const Eigen::Matrix3Xd> from(a[0].data(), 3, static_cast<Eigen::Index>(a.size())),
      to(b[0].data(), 3, static_cast<Eigen::Index>(b.size()));
  const Eigen::Matrix4d fit = Eigen::umeyama(from, to, false);
  return std::sqrt(((fit.topLeftCorner<3, 3>() * from).colwise() + fit.topRightCorner<3, 1>() - to).squaredNorm() /
                   static_cast<double>(a.size()));
}

TEST(RgbdOdometry, FollowsAKitchenOfSevenScenes) {
  const std::filesystem::path path = find_recording("seven_scenes_kitchen/visit_1");
  DVI_SKIP_WITHOUT(path);
  Drive drive = datasets::read_drive(path);
  drive.scan_headers.resize(30);
  const Odometry found = estimate_odometry(drive, {});
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  EXPECT_LT(absolute_trajectory_error_m(drive, found.world_from_lidar), 0.01);
}

TEST(RgbdOdometry, FollowsFreiburg1RpyWithEverySecondImage) {
  // Its excerpt has no ground truth at these frames: both estimates must agree.
  const std::filesystem::path path = find_recording("foreign_files/tum_fr1_rpy");
  DVI_SKIP_WITHOUT(path);
  const Drive all = datasets::read_drive(path);
  Drive half = all;
  half.scan_headers.clear();
  for (std::size_t i = 0; i < all.scan_headers.size(); i += 2) half.scan_headers.push_back(all.scan_headers[i]);
  half.scans = Lazy<Scan>::through(half.scan_headers.size(), [scans = all.scans](std::size_t i) { return scans[2 * i]; });
  const Odometry found = estimate_odometry(all, {}), coarse = estimate_odometry(half, {});
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  EXPECT_THAT(coarse.warnings, testing::IsEmpty());
  for (const ScanHeader& header : half.scan_headers) {
    const SE3 off =
        found.world_from_lidar.at(header.time_ns).value().inverse() * coarse.world_from_lidar.at(header.time_ns).value();
    EXPECT_LT(off.t.norm(), 0.02) << header.name;
    EXPECT_LT(to_degrees(so3_log(off.R).norm()), 0.8) << header.name;
  }
}

}  // namespace
}  // namespace dvi::odometry
