#include "dvi/objects/stationary_objects.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

constexpr std::int64_t kStep = 100'000'000;

Label car(int track, double x, double y) {
  Label out;
  out.track = track;
  out.box = Box{{Eigen::Matrix3d::Identity(), {x, y, 0}}, {4, 2, 1.5}};
  return out;
}

// Makes a drive at 10 m/s. Track 1 is parked on the left, and track 2 drives ahead on the right.
Drive make_parked_and_moving() {
  Drive drive;
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
  return drive;
}

CameraEvidence evidence_of(const Drive& drive, const Trajectory& world_from_lidar) {
  return {.drive = drive, .world_from_lidar = world_from_lidar, .name = "drive", .sources = {MaskSource::labels}};
}

TEST(StationaryObjects, CountThePixelsThatRemoveMovingWouldKeep) {
  const Drive drive = make_parked_and_moving();
  const RemovalOptions options;
  const std::optional<StationaryObjects> found = count_stationary(evidence_of(drive, drive.poses), options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tracks, 2U);
  EXPECT_EQ(found->stationary, 1U);
  std::size_t parked = 0;
  Drive only = make_parked_and_moving();
  for (Frame& frame : only.frames) frame.labels.pop_back();
  const Lazy<cv::Mat1b> masks = draw_label_masks(only, {MaskSource::labels}, shared(only.labels()), options.masks);
  for (std::size_t i = 0; i < masks.size(); ++i) parked += static_cast<std::size_t>(cv::countNonZero(*masks[i]));
  EXPECT_GT(parked, 0U);
  EXPECT_EQ(found->pixels, parked);
}

TEST(StationaryObjects, AreNotCountedWithoutPosesOrLabelsOrIfTheyRemain) {
  Drive drive = make_parked_and_moving();
  const Trajectory none;
  CameraEvidence evidence = evidence_of(drive, drive.poses);
  EXPECT_FALSE(count_stationary(evidence_of(drive, none), {})) << "no poses";
  EXPECT_FALSE(count_stationary(evidence, {.remove = Remove::moving, .masks = {}, .objects = {}})) << "they remain";
  evidence.sources = {MaskSource::files};
  drive.masks = {10, [](std::size_t) { return cv::Mat1b(100, 200, uchar{255}); }};
  EXPECT_FALSE(count_stationary(evidence, {})) << "mask files do not show the motion state";
  evidence.sources.clear();
  EXPECT_FALSE(count_stationary(evidence, {})) << "nothing is removed";
}

}  // namespace
}  // namespace dvi::objects
