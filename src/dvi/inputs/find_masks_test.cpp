#include "dvi/inputs/find_masks.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::inputs {
namespace {

constexpr std::int64_t kStep = 100'000'000;

Label car(int track, double x, double y) {
  Label out;
  out.track = track;
  out.box = Box{{Eigen::Matrix3d::Identity(), {x, y, 0}}, {4, 2, 1.5}};
  return out;
}

// The recording car does 10 m/s; track 1 is parked on the left, track 2 drives ahead on the right.
Recording labeled() {
  Recording open{{}, objects::MaskSource::labels};
  Drive& drive = open.drive;
  drive.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  std::vector<StampedPose> poses;
  for (int i = 0; i < 10; ++i) {
    poses.push_back({i * kStep, {Eigen::Matrix3d::Identity(), {1.0 * i, 0, 0}}});
    Frame frame;
    frame.time_ns = i * kStep;
    frame.labels = {car(1, 30 - i, 5), car(2, 15, -5)};
    drive.frames.push_back(frame);
  }
  drive.poses = Trajectory(poses);
  drive.labeled = true;
  return open;
}

TEST(StandingTracks, AreTheHoleThatRemoveMovingLeaves) {
  const Recording open = labeled();
  job::Job job;
  const std::optional<StandingTracks> found = standing_tracks(open, open.drive.poses, job);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tracks, 2U);
  EXPECT_EQ(found->standing, 1U);
  std::size_t parked = 0;
  Recording only = labeled();
  for (Frame& frame : only.drive.frames) frame.labels.pop_back();
  const Lazy<cv::Mat1b> masks =
      objects::find_masks(only.drive, objects::MaskSource::labels, shared(only.drive.labels()), job.options.masks);
  for (std::size_t i = 0; i < masks.size(); ++i) parked += static_cast<std::size_t>(cv::countNonZero(*masks[i]));
  EXPECT_GT(parked, 0U);
  EXPECT_EQ(found->pixels, parked);
}

TEST(StandingTracks, AreNoneWhereNothingSaysWhatStands) {
  Recording open = labeled();
  job::Job job;
  EXPECT_FALSE(standing_tracks(open, {}, job)) << "no poses";
  job.read.remove = job::Remove::moving;
  EXPECT_FALSE(standing_tracks(open, open.drive.poses, job)) << "they stay";
  job.read.remove = job::Remove::labeled;
  open.masks_from = objects::MaskSource::files;
  open.drive.masks = {10, [](std::size_t) { return cv::Mat1b(100, 200, uchar{255}); }};
  EXPECT_FALSE(standing_tracks(open, open.drive.poses, job)) << "mask files do not say";
  open.masks_from.reset();
  EXPECT_FALSE(standing_tracks(open, open.drive.poses, job)) << "nothing is removed";
}

}  // namespace
}  // namespace dvi::inputs
