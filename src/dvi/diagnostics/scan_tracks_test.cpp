#include "dvi/diagnostics/scan_tracks.h"

#include <gtest/gtest.h>

#include "dvi/diagnostics/test_drive.h"

namespace dvi::diagnostics {
namespace {

TEST(ScanTracks, FollowTheTruth) {
  const Drive drive = make_test_drive(2, 40);
  const std::vector<ScanTrack> tracks = estimate_scan_tracks(drive, {});
  ASSERT_EQ(tracks.size(), 1);
  const auto& poses = tracks[0].world_from_lidar.poses();
  ASSERT_EQ(poses.size(), drive.scan_headers.size());
  const SE3 motion = poses.front().world_from_body.inverse() * poses.back().world_from_body;
  const SE3 truth = drive.poses.poses().front().world_from_body.inverse() * drive.poses.poses().back().world_from_body;
  EXPECT_LT((motion.t - truth.t).norm(), 0.1);
}

TEST(ScanTracks, AreEmptyForTooFewScans) {
  Drive drive = make_test_drive(1, 0);
  drive.scan_headers.resize(1);
  EXPECT_TRUE(estimate_scan_tracks(drive, {}).empty());
  drive.scan_headers.clear();
  EXPECT_TRUE(estimate_scan_tracks(drive, {}).empty());
}

}  // namespace
}  // namespace dvi::diagnostics
