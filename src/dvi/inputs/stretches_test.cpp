#include "dvi/inputs/stretches.h"

#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/synth/scene.h"

namespace dvi::inputs {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// The synthetic street with the scans and frames that `keep` accepts. Its given poses are the truth.
template <class Keep>
Drive street(int frames, const Keep& keep) {
  synth::SynthOptions options;
  options.frames = frames, options.width = 160, options.height = 90, options.beams = 24, options.columns = 600;
  Drive drive = synth::drive_of(std::make_shared<const synth::Scene>(options));
  std::vector<std::size_t> kept;
  std::vector<ScanHeader> headers;
  std::vector<Frame> images;
  for (std::size_t i = 0; i < drive.scan_headers.size(); ++i)
    if (keep(i)) kept.push_back(i), headers.push_back(drive.scan_headers[i]), images.push_back(drive.frames[i]);
  drive.scans = Lazy<Scan>::through(kept.size(), [all = drive.scans, kept](std::size_t i) { return all[kept[i]]; });
  drive.scan_headers = headers;
  drive.frames = images;
  return drive;
}

/// A drive with the times of such scans only.
template <class Keep>
Drive times_of(int scans, const Keep& keep) {
  Drive drive;
  for (int i = 0; i < scans; ++i)
    if (keep(i)) drive.scan_headers.push_back({"", i * std::int64_t{100'000'000}, 0, 0, {}});
  return drive;
}

TEST(Stretches, EndAtAGapThatGivenPosesDoNotCover) {
  const Drive drive = times_of(30, [](int i) { return i < 8 || i >= 20; });
  const std::vector<Stretch> found = split_at_gaps(drive, {});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].last, 8U);
  EXPECT_EQ(found[1].first, 8U);
  std::vector<StampedPose> given;
  for (const ScanHeader& header : drive.scan_headers) given.push_back({header.time_ns, SE3()});
  EXPECT_EQ(split_at_gaps(drive, Trajectory(given)).size(), 1U) << "given poses cover both sides";
  given.resize(7);
  EXPECT_EQ(split_at_gaps(drive, Trajectory(given)).size(), 2U) << "given poses cover one side";
  EXPECT_EQ(split_at_gaps(times_of(30, [](int i) { return i < 8 || i >= 16; }), {}).size(), 1U) << "a short gap";
  EXPECT_EQ(split_at_gaps(times_of(90, [](int i) { return i % 15 == 0; }), {}).size(), 1U) << "the median step";
  EXPECT_EQ(split_at_gaps({}, {}).size(), 1U);
}

TEST(Stretches, AreRegisteredOrSeparated) {
  const Drive drive = street(40, [](std::size_t i) { return i < 8 || i >= 32; });
  Progress progress(ProgressStyle::quiet);
  const odometry::Odometry found = estimate_odometry(drive, {}, {}, progress);
  EXPECT_EQ(found.scans.size(), drive.scan_headers.size());
  const std::vector<StampedPose>& poses = found.world_from_lidar.poses();
  ASSERT_EQ(poses.size(), drive.scan_headers.size());
  const double step_m = (poses[8].world_from_body.t - poses[7].world_from_body.t).norm();
  const double true_m = (drive.poses.at(poses[8].time_ns)->t - drive.poses.at(poses[7].time_ns)->t).norm();
  if (step_m < kSeparationM)
    EXPECT_NEAR(step_m, true_m, 0.3);
  else
    EXPECT_THAT(found.warnings, Contains(HasSubstr("no scan for 2.5 s, between frames 7 and 32, and neither poses nor scans")));
  EXPECT_LT(path_length_m(poses), 60) << "the path length excludes the distance to a separated part";
}

TEST(Stretches, WithGivenPosesAreAlignedToThem) {
  const Drive drive = street(36, [](std::size_t i) { return i < 8 || i >= 28; });
  std::vector<StampedPose> some;  // only the middle of each stretch
  for (const StampedPose& pose : drive.poses.poses())
    if (const auto k = (pose.time_ns - drive.frames.front().time_ns) / 100'000'000; (k > 2 && k < 6) || (k > 30 && k < 34))
      some.push_back(pose);
  Progress progress(ProgressStyle::quiet);
  const odometry::Odometry found = estimate_odometry(drive, {}, Trajectory(some), progress);
  EXPECT_THAT(found.warnings, testing::Not(Contains(HasSubstr("neither poses nor scans"))));
  for (const StampedPose& pose : some)
    EXPECT_LT((found.world_from_lidar.at(pose.time_ns)->t - pose.world_from_body.t).norm(), 0.2);
}

}  // namespace
}  // namespace dvi::inputs
