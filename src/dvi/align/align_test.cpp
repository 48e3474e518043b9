#include "dvi/align/align.h"

#include <gtest/gtest.h>

#include "dvi/align/test_wall.h"
#include "dvi/core/threads.h"

namespace dvi {
namespace {

TEST(Align, FindsTheJitterOfAllFramesTogether) {
  ShakyDrive drive(10, 0.3);
  const double before = drive.residual_deg(std::vector<ViewAlignment>(10));
  const std::vector<ViewAlignment> found = align(drive.views, drive.map, {});
  EXPECT_GT(before, 0.12);
  EXPECT_LT(drive.residual_deg(found), 0.012);
  for (const ViewAlignment& a : found) EXPECT_LT(a.energy_after, a.energy_before);
}

TEST(Align, LeavesExactPosesAlone) {
  ShakyDrive drive(6, 0);
  const std::vector<ViewAlignment> found = align(drive.views, drive.map, {});
  EXPECT_LT(drive.residual_deg(found), 0.006);
}

TEST(Align, PosesOfTheViewsAreCorrected) {
  ShakyDrive drive(4, 0.3);
  const Views given = drive.views;
  const std::vector<ViewAlignment> found = align(drive.views, drive.map, {});
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Matrix3d expected = pitch_yaw(found[i].pitch, found[i].yaw) * given[i].camera_from_world.R;
    EXPECT_LT((drive.views[i].camera_from_world.R - expected).norm(), 1e-12);
    EXPECT_EQ(drive.views[i].camera_from_world.inverse().t.isApprox(given[i].camera_from_world.inverse().t, 1e-9), true);
  }
}

TEST(Align, SwitchedOffItDoesNothing) {
  ShakyDrive drive(3, 0.3);
  const Eigen::Matrix3d before = drive.views[1].camera_from_world.R;
  EXPECT_EQ(align(drive.views, drive.map, {.enabled = false})[1].pitch, 0);
  EXPECT_EQ(drive.views[1].camera_from_world.R, before);
}

TEST(Align, WithoutSharedPointsNothingMoves) {
  ShakyDrive drive(3, 0.3, {0, 0, 320, 240});  // masks cover whole frames
  for (const ViewAlignment& a : align(drive.views, drive.map, {})) {
    EXPECT_EQ(a.points, 0);
    EXPECT_EQ(a.pitch, 0);
    EXPECT_EQ(a.yaw, 0);
  }
  ShakyDrive empty(3, 0.3);
  for (const ViewAlignment& a : align(empty.views, {}, {})) EXPECT_EQ(a.yaw, 0);
}

TEST(Align, SameWhateverTheThreads) {
  std::vector<ViewAlignment> found[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    ShakyDrive drive(5, 0.3);
    found[threads - 1] = align(drive.views, drive.map, {});
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(found[0][i].pitch, found[1][i].pitch);
    EXPECT_EQ(found[0][i].yaw, found[1][i].yaw);
  }
}

}  // namespace
}  // namespace dvi
