#include "dvi/align/align.h"

#include <type_traits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/align/test_wall.h"
#include "dvi/core/threads.h"

namespace dvi::align {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const PoseError kExact{}, kJitter{.jitter_deg = 0.2};

TEST(Align, FindsTheJitterOfAllFrames) {
  ShakyDrive drive(10, kJitter);
  EXPECT_GT(drive.residual_deg(std::vector<ViewAlignment>(10)), 0.08);
  const Cameras found = align(drive.views, {drive.map, drive.views}, {});
  EXPECT_LT(drive.residual_deg(found.views), 0.015);
  EXPECT_TRUE(found.sequences.at(0).kept);
  EXPECT_THAT(found.sequences.front().warnings, IsEmpty());
  for (const ViewAlignment& a : found.views) {
    EXPECT_LT(a.offset_after_px, a.offset_before_px);
    EXPECT_LT(a.offset_after_px, 0.2);
  }
}

TEST(Align, DoesNotChangeExactPoses) {
  ShakyDrive drive(8, kExact);
  for (const ViewAlignment& a : align(drive.views, {drive.map, drive.views}, {}).views)
    EXPECT_LT(a.rotation.norm(), 4e-5);  // .002 degrees
}

TEST(Align, AcceptsDifferentExposures) {
  ShakyDrive drive(8, {.jitter_deg = 0.2, .gain_step = 0.9});
  EXPECT_LT(drive.residual_deg(align(drive.views, {drive.map, drive.views}, {}).views), 0.015);
}

TEST(Align, CorrectsThePosesOfTheViews) {
  ShakyDrive drive(6, kJitter);
  const Views& given = drive.views;
  const Cameras found = align(drive.views, {drive.map, drive.views}, {});
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Matrix3d expected = so3_exp(found.views[i].rotation) * given[i].camera_from_world.R;
    EXPECT_LT((found.camera_from_world[i].R - expected).norm(), 1e-9);
    EXPECT_TRUE(found.camera_from_world[i].inverse().t.isApprox(given[i].camera_from_world.inverse().t, 1e-9));
  }
}

TEST(Align, DoesNothingIfDisabled) {
  ShakyDrive drive(3, kJitter);
  const Cameras found = align(drive.views, {drive.map, drive.views}, {.enabled = false});
  EXPECT_EQ(found.views[1].rotation, Eigen::Vector3d::Zero());
  EXPECT_EQ(found.camera_from_world[1].R, drive.views[1].camera_from_world.R);
}

TEST(Align, WarnsAndKeepsThePosesWithoutSharedPoints) {
  ShakyDrive drive(3, {.jitter_deg = 0.2, .hole = {0, 0, 320, 240}});  // masks cover whole frames
  ShakyDrive empty(3, kJitter);
  const map::StaticMap no_map;
  for (const Cameras& found :
       {align(drive.views, {drive.map, drive.views}, {}), align(empty.views, {no_map, empty.views}, {})}) {
    for (const ViewAlignment& a : found.views) {
      EXPECT_EQ(a.points, 0);
      EXPECT_EQ(a.rotation, Eigen::Vector3d::Zero());
    }
    EXPECT_THAT(found.sequences.front().warnings, ElementsAre(HasSubstr("no two frames")));
  }
}

TEST(Align, DoesNotChangeASingleFrame) {
  ShakyDrive drive(1, kJitter);
  EXPECT_EQ(align(drive.views, {drive.map, drive.views}, {}).views[0].rotation, Eigen::Vector3d::Zero());
}

TEST(Align, FindsOnlyTheJitterOfAStationaryCamera) {
  ShakyDrive drive(8, {.jitter_deg = 0.2, .speed = {0, 0, 0}});
  const Cameras found = align(drive.views, {drive.map, drive.views}, {});
  EXPECT_THAT(found.sequences.front().warnings, ElementsAre(HasSubstr("hardly moves")));
  for (const ViewAlignment& a : found.views) EXPECT_LT(a.offset_after_px, 0.2);
  EXPECT_LT(drive.residual_deg(found.views), 0.015);
}

TEST(Align, DoesNotRotateAStationaryCameraAsAWhole) {
  ShakyDrive drive(8, {.jitter_deg = 0.2, .mounting = {0.004, -0.003, 0}, .speed = {0, 0, 0}});
  const Cameras found = align(drive.views, {drive.map, drive.views}, {});
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ViewAlignment& a : found.views) sum += a.rotation;
  EXPECT_TRUE(found.sequences.at(0).kept);
  EXPECT_LT(sum.norm(), 1e-9);
  EXPECT_LT(found.sequences.at(0).mounting.norm(), 1e-9);
}

TEST(Align, DoesNotRotateACameraWithRegisteredDepthAsAWhole) {
  ShakyDrive drive(8, {.jitter_deg = 0.2, .mounting = {0.004, -0.003, 0}});
  for (View& view : drive.views.views) view.registered_depth = true;
  const Cameras found = align(drive.views, {drive.map, drive.views}, {});
  EXPECT_LT(found.sequences.at(0).mounting.norm(), 1e-9);
  for (View& view : drive.views.views) view.registered_depth = false;
  EXPECT_GT(align(drive.views, {drive.map, drive.views}, {}).sequences.at(0).mounting.norm(), 1e-3);
}

// The first drive has exact poses, the second a rotated camera.
TEST(Align, AlignsAnotherDriveToTheFirst) {
  const ShakyDrive first(8, kExact);
  ShakyDrive second(8, {.jitter_deg = 0.1, .mounting = {0.002, -0.0015, 0}});
  Views both = first.views;
  for (View view : second.views.views) {
    view.sequence = view.drive = 1;
    both.views.push_back(view);
  }
  const auto joined = [](const auto& a, const auto& b) {
    using Item = std::decay_t<decltype(*a[0])>;
    return Lazy<Item>(16, 16, [a, b](std::size_t i) { return i < 8 ? *a[i] : *b[i - 8]; });
  };
  both.images = joined(first.views.images, second.views.images);
  both.masks = joined(first.views.masks, second.views.masks);
  const Cameras found = align(both, {first.map, both}, {});
  ASSERT_EQ(found.sequences.size(), 2);
  EXPECT_TRUE(found.sequences[1].kept);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LT(found.views[i].rotation.norm(), 4e-5) << "the first drive is aligned by itself";
    EXPECT_LT((found.views[8 + i].rotation - second.errors[i]).head<2>().norm(), 3e-4) << i;
  }
}

TEST(Align, ExpectsLargerErrorsForHandheldCameras) {
  EXPECT_EQ(get_expected_rotation_deg({}, Sensor::lidar), 0.1);
  EXPECT_EQ(get_expected_rotation_deg({}, Sensor::depth_camera), 0.5);
  AlignOptions given;
  given.rotation_deg = 0.2;
  EXPECT_EQ(get_expected_rotation_deg(given, Sensor::depth_camera), 0.2);
}

TEST(Align, WarnsOfPosesThatDoNotFit) {
  ShakyDrive drive(10, {.speed = {0, 0, 5}});
  for (View& view : drive.views.views) view.camera_from_world.t.z() *= -1;  // backwards
  EXPECT_THAT(align(drive.views, {drive.map, drive.views}, {}).sequences.front().warnings,
              ElementsAre(HasSubstr("position error")));
}

TEST(Align, ThePublishedSearchCorrectsOneFrameAmongExactOnes) {
  ShakyDrive exact(3, kExact), drive = exact;
  const Eigen::Matrix3d off = so3_exp({0.0032, -0.0021, 0});
  drive.views.views[1].camera_from_world.R = off.transpose() * exact.views[1].camera_from_world.R;
  drive.views.views[1].camera_from_world.t = off.transpose() * exact.views[1].camera_from_world.t;
  const Cameras found = align(drive.views, {drive.map, drive.views}, {.method = AlignMethod::paper});
  EXPECT_NEAR(found.views[1].rotation.x(), 0.0032, 2e-4);
  EXPECT_NEAR(found.views[1].rotation.y(), -0.0021, 2e-4);
}

TEST(Align, DoesNotDependOnTheNumberOfThreads) {
  Cameras found[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    ShakyDrive drive(6, kJitter);
    found[threads - 1] = align(drive.views, {drive.map, drive.views}, {});
  }
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(found[0].views[i].rotation, found[1].views[i].rotation);
}

}  // namespace
}  // namespace dvi::align
