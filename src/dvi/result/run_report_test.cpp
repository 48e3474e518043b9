#include "dvi/result/run_report.h"

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"

namespace dvi::result {
namespace {

using testing::HasSubstr;
using testing::Not;

RunReport whole_report() {
  RunReport report;
  report.version = "1.2.3";
  report.method = "dvi";
  DriveReport drive;
  drive.path = "/a/drive";
  drive.frames = 7;
  drive.scans = 9;
  drive.poses.from = "loam";
  drive.poses.loam = inputs::SharpnessReport{0.01, 0.02, 30, 40};
  drive.poses.odometry.emplace();
  drive.poses.odometry->path_m = 12.5;
  drive.poses.odometry->drift.lag_correction = inputs::LengthReport{0.001, 0.01};
  drive.poses.odometry->scans.emplace_back().features = 5;
  drive.alignment = DriveAlignmentReport{true, {0.1, 0.2, 0.3}};
  drive.warnings = {"a scan is missing"};
  report.drives = {drive};
  FrameReport frame;
  frame.number = 3;
  frame.name = "0003";
  frame.hole = {.pixels = 100, .copied = 60, .copied_elsewhere = 10, .interpolated = 25, .synthesized = 0, .empty = 5};
  frame.exposure_gain = {1, 1.5F, 2};
  report.frames = {frame};
  report.hole = report.frames[0].hole;
  report.artifacts = {.hole = 100, .overshoots = 1, .hole_between = 90, .ring_between = 50, .flashes = 2, .ring_flashes = 3};
  report.stationary = objects::StationaryObjects{.tracks = 5, .stationary = 4, .pixels = 80};
  report.map.emplace();
  report.map->points = 1000;
  report.map->counts.returns = 5000;
  report.cost = {{{"map", 2, 3}, {"fill", 5, 9}}, {{"depth", 1.5}}, 2, 123'000'000};
  report.warnings = {"something"};
  return report;
}

class ReportFile : public testing::Test {
 protected:
  ReportFile() : file(fs::path(testing::TempDir()) / ("report_" + std::to_string(getpid()) + ".json")) {}
  ~ReportFile() override { fs::remove(file); }
  fs::path file;
};

TEST(HoleReport, SharesAddUp) {
  const HoleReport hole{
      .pixels = 200, .copied = 100, .copied_elsewhere = 20, .interpolated = 50, .synthesized = 10, .empty = 20};
  const HoleParts share = hole.share();
  EXPECT_DOUBLE_EQ(share.copied, 0.5);
  EXPECT_DOUBLE_EQ(share.unobserved, 0.4);
  EXPECT_DOUBLE_EQ(share.copied + share.copied_elsewhere + share.unobserved, 1);
  HoleReport sum = hole;
  sum += hole;
  EXPECT_EQ(sum.pixels, 400U);
  EXPECT_DOUBLE_EQ(sum.share().empty, share.empty);
}

TEST(HoleReport, AFrameWithoutAHoleHasNoShares) { EXPECT_EQ(HoleReport{}.share().unobserved, 0); }

TEST_F(ReportFile, IsReadBackAsItWasWritten) {
  const RunReport report = whole_report();
  write_file(file, to_json(report));
  const std::optional<RunReport> read = read_run_report(file);
  ASSERT_TRUE(read);
  EXPECT_EQ(to_json(*read), to_json(report));
  EXPECT_EQ(read->brief("out"), report.brief("out"));
}

TEST_F(ReportFile, WhatIsNoReportCountsAsNone) {
  EXPECT_FALSE(read_run_report(file));
  for (const char* text : {"", "{", "[]", R"({"frames": 3})"}) {
    write_file(file, text);
    EXPECT_FALSE(read_run_report(file)) << text;
  }
}

TEST(RunReport, BriefSaysWhatWasFilledAndWhatItCost) {
  const std::string text = whole_report().brief("out");
  for (const char* part : {"1 frames, 100 hole pixels: 60.0 % copied, 10.0 % from other cameras or drives, 30.0 % unobserved "
                           "(25.0 % interpolated, 5.0 % left black)",
                           "4 of 5 removed tracks stand; they are 80 % of the hole; --remove moving would keep them",
                           "6.0 CPU s a frame, peak memory 123 MB", "out/compare.mp4"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(RunReport, BriefLeavesOutWhatStandsWhereItIsLittleOfTheHole) {
  RunReport report = whole_report();
  report.stationary->pixels = 50;
  EXPECT_THAT(report.brief("out"), Not(HasSubstr("stand")));
}

TEST(CpuClock, NestedStagesAreBookedOnce) {
  CpuClock clock;
  const auto spin = [](double seconds) {
    for (const double begun = thread_cpu_seconds(); thread_cpu_seconds() < begun + seconds;) {
    }
    return 7;
  };
  EXPECT_EQ(clock.time("outer", [&] { return clock.time("inner", spin, 0.02); }), 7);
  EXPECT_GE(clock.seconds().at("inner"), 0.02);
  EXPECT_LT(clock.seconds().at("outer"), clock.seconds().at("inner"));
}

}  // namespace
}  // namespace dvi::result
