#include <gtest/gtest.h>

#include <algorithm>

#include "dvi/objects/motion.h"

namespace dvi::objects {
namespace {

constexpr std::int64_t kStepNs = 100'000'000;

Label label(int track, double x) {
  Label out;
  out.track = track;
  out.box = Box{{Eigen::Matrix3d::Identity(), {x, 3, 0}}, {4, 2, 1.5}};
  return out;
}

// Makes a drive at 10 m/s. Track 1 is parked at x = 30, and its labels have errors. Track 2 drives ahead, track 3 has one
// label, and track 4 has no box.
Drive labeled_drive() {
  Drive drive;
  std::vector<StampedPose> poses;
  for (int i = 0; i < 20; ++i) {
    poses.push_back({i * kStepNs, {Eigen::Matrix3d::Identity(), {1.0 * i, 0, 0}}});
    Frame frame;
    frame.time_ns = i * kStepNs;
    Label boxless;
    boxless.track = 4;
    frame.labels = {label(1, 30 - i + 0.2 * (i % 3)), label(2, 15), boxless};
    if (i == 5) frame.labels.push_back(label(3, 8));
    drive.frames.push_back(frame);
  }
  drive.poses = Trajectory(poses);
  return drive;
}

TEST(TrackMotions, DistinguishWaitingCarsFromParkedOnes) {
  Drive drive = labeled_drive();
  for (int i = 0; i < 20; ++i) {
    std::vector<Label>& labels = drive.frames[static_cast<std::size_t>(i)].labels;
    labels.push_back(label(5, 12 - i + (i < 12 ? 0 : 0.3 * (i - 12) * (i - 12))));  // waits, then drives off
    labels.push_back(label(7, 70 - i + 0.5 * (i % 2)));                             // parked far away, labeled badly
  }
  const std::vector<TrackMotion> motions = measure_track_motions(drive, drive.labels(), drive.poses);
  ASSERT_EQ(motions.size(), 5U);
  const auto moves = [&](int track) {
    return std::find_if(motions.begin(), motions.end(), [&](const TrackMotion& m) { return m.track == track; })->moves;
  };
  EXPECT_TRUE(moves(5));
  EXPECT_FALSE(moves(7));
  EXPECT_TRUE(moves(2));
  EXPECT_EQ(motions[1].track, 2);
  EXPECT_NEAR(motions[1].speed_mps, 10, 1e-6);
  EXPECT_EQ(motions[1].frames, 20U);
}

TEST(StationaryTracks, KeepTheirPositionInTheWorld) {
  const Drive drive = labeled_drive();
  EXPECT_EQ(find_stationary_tracks(drive, drive.poses), (std::set<int>{1, 3}));
}

TEST(StationaryTracks, AreUnknownWithoutPoses) { EXPECT_TRUE(find_stationary_tracks(labeled_drive(), {}).empty()); }

TEST(StationaryTracks, CanBeRemovedFromLabels) {
  const Drive drive = labeled_drive();
  for (const std::vector<Label>& frame : remove_stationary(drive, drive.poses)) {
    ASSERT_EQ(frame.size(), 2U);
    EXPECT_EQ(frame[0].track, 2);
    EXPECT_EQ(frame[1].track, 4);
  }
}

}  // namespace
}  // namespace dvi::objects
