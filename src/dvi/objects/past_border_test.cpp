#include "dvi/objects/past_border.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

constexpr std::int64_t kFramePeriodNs = 100'000'000;
const MaskOptions kDefaults;

// Makes a drive at 10 m/s along x that turns left by `turn` radians per frame. The camera looks along x and has a field of view
// of 45 degrees to either side.
Drive make_drive(double turn = 0) {
  Drive drive;
  drive.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  std::vector<StampedPose> poses;
  for (int i = 0; i < 30; ++i) {
    drive.frames.emplace_back().time_ns = i * kFramePeriodNs;
    poses.push_back(
        {i * kFramePeriodNs, {Eigen::AngleAxisd(turn * i, Eigen::Vector3d::UnitZ()).toRotationMatrix(), {1.0 * i, 0, 0}}});
  }
  drive.poses = Trajectory(poses);
  return drive;
}

// Returns the label of a parked car in LiDAR axes of a frame.
Label make_parked(const Drive& drive, std::size_t frame, double x, double y) {
  const SE3 world_from_box{Eigen::Matrix3d::Identity(), {x, y, 0}};
  Label label;
  label.track = 1;
  label.box = Box{drive.poses.at(drive.frames[frame].time_ns)->inverse() * world_from_box, {4, 2, 1.5}};
  return label;
}

cv::Mat1b draw_labels(const Drive& drive, const std::vector<Label>& labels) {
  cv::Mat1b mask(drive.camera.height, drive.camera.width, uchar{0});
  for (const Label& label : labels) mask |= draw_label(label, drive.camera, drive.camera_from_lidar, {.box_margin_m = 0});
  return mask;
}

class PastBorder : public testing::TestWithParam<bool> {
 protected:
  const Trajectory no_poses_;
  const Trajectory& poses_of(const Drive& drive) const { return GetParam() ? drive.poses : no_poses_; }
};

TEST_P(PastBorder, MasksTheVisiblePartOfACarThatIsNoLongerLabeled) {
  const Drive drive = make_drive(GetParam() ? 0.01 : 0);
  // The car is labeled while half of it is visible: until the right border passes its middle, at x = 25, 5 m to the right.
  FrameLabels labels(30);
  std::size_t last = 0;
  for (std::size_t i = 5; i < 30; ++i) {
    const Label label = make_parked(drive, i, 25, -5);
    const Eigen::Vector3d& center = label.box->frame_from_box.t;
    if (center.x() < -center.y()) break;
    labels[last = i].push_back(label);
  }
  const FrameLabels all = extend_past_border(drive, labels, poses_of(drive), kDefaults);
  int covered = 0;
  for (std::size_t i = last + 1; i < 30; ++i) {
    const cv::Mat1b truth = draw_labels(drive, {make_parked(drive, i, 25, -5)}), mask = draw_labels(drive, all[i]);
    EXPECT_EQ(cv::countNonZero(truth & ~mask), 0) << i;
    covered += cv::countNonZero(truth);
    EXPECT_EQ(cv::countNonZero(truth) == 0, all[i].empty()) << i;
  }
  EXPECT_GT(covered, 500);
  EXPECT_TRUE(all[29].empty()) << "behind";
}

TEST_P(PastBorder, ExtendsBackwardFromTheFirstLabel) {
  const Drive drive = make_drive();
  FrameLabels labels(30);
  for (std::size_t i = 10; i < 30; ++i) {  // overtakes on the left, 5 m/s faster
    Label label;
    label.track = 1;
    label.box = Box{{Eigen::Matrix3d::Identity(), {2.5 + 0.5 * (static_cast<double>(i) - 10), 3, 0}}, {4, 2, 1.5}};
    labels[i].push_back(label);
  }
  const FrameLabels all = extend_past_border(drive, labels, poses_of(drive), kDefaults);
  ASSERT_EQ(all[9].size(), 1U);
  EXPECT_NEAR(all[9].front().box->frame_from_box.t.x(), 2.0, 1e-9);
  EXPECT_TRUE(all[0].empty()) << "more than a second earlier";
}

TEST_P(PastBorder, DoesNotExtendTracksThatEndWithinTheImage) {
  const Drive drive = make_drive();
  FrameLabels labels(30);
  for (std::size_t i = 0; i < 10; ++i) labels[i].push_back(make_parked(drive, i, 40, 2));
  const FrameLabels all = extend_past_border(drive, labels, poses_of(drive), kDefaults);
  for (std::size_t i = 10; i < 30; ++i) EXPECT_TRUE(all[i].empty()) << i;
}

TEST_P(PastBorder, DoesNotExtendLabelsWithoutTrackOrBox) {
  const Drive drive = make_drive();
  FrameLabels labels(30);
  for (std::size_t i = 0; i < 10; ++i) {
    labels[i].push_back(make_parked(drive, i, 14, -5));
    labels[i].back().track = -1;
    Label flat;
    flat.track = 2;
    flat.rect = cv::Rect2d(0, 40, 30, 20);
    labels[i].push_back(flat);
  }
  const FrameLabels all = extend_past_border(drive, labels, poses_of(drive), kDefaults);
  for (std::size_t i = 10; i < 30; ++i) EXPECT_TRUE(all[i].empty()) << i;
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutPoses, PastBorder, testing::Bool());

}  // namespace
}  // namespace dvi::objects
