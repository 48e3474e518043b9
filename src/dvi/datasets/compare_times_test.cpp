#include "dvi/datasets/compare_times.h"

#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kOneSecondNs = 1'000'000'000;

/// Makes a drive of `seconds` at 10 Hz in which the clock of the images is `ahead_s` ahead of that of the scans.
Drive drive_with_clocks(double seconds, double ahead_s) {
  Drive drive;
  drive.path = "drive";
  drive.camera_name = "front";
  for (int i = 0; i < 10 * seconds; ++i) {
    const std::int64_t time = 1000 * kOneSecondNs + i * kOneSecondNs / 10;
    drive.frames.push_back({i, "", time + static_cast<std::int64_t>(1e9 * ahead_s), {}, {}});
    drive.scan_headers.push_back({"", time, time - kOneSecondNs / 20, time + kOneSecondNs / 20, {}});
  }
  return drive;
}

std::vector<std::string> clock_warnings(Drive drive) {
  compare_times(drive);
  return drive.warnings;
}

TEST(CompareTimes, RefusesImagesWithoutAnyScanAndStatesTheDifference) {
  for (const auto& [ahead, words] :
       {std::pair(37.0, "37.00 s ahead (TAI against UTC)"), std::pair(-18.0, "18.00 s behind (GPS time against UTC)"),
        std::pair(3600.0, "3600.00 s ahead (a time zone)")})
    EXPECT_THAT(input_error([ahead = ahead] { clock_warnings(drive_with_clocks(2, ahead)); }),
                AllOf(HasSubstr("no scan belongs to any image"), HasSubstr(words), HasSubstr("[camera.front] in dvi.toml")));
}

TEST(CompareTimes, WarnsOfSpansOfEqualLengthAtDifferentTimes) {
  EXPECT_THAT(clock_warnings(drive_with_clocks(60, -18)),
              ElementsAre(AllOf(HasSubstr("18.00 s behind (GPS time"), HasSubstr("add 18.00 to offset_s"))));
  EXPECT_THAT(clock_warnings(drive_with_clocks(2, 1)), ElementsAre(HasSubstr("add -1.00 to offset_s")));
}

TEST(CompareTimes, AcceptsSensorsThatStartOrEndEarlier) {
  EXPECT_THAT(clock_warnings(drive_with_clocks(20, 0.2)), IsEmpty());
  Drive late = drive_with_clocks(20, 0);
  late.scan_headers.erase(late.scan_headers.begin(), late.scan_headers.begin() + 70);
  EXPECT_THAT(clock_warnings(late), IsEmpty());
  late.frames.resize(150);
  EXPECT_THAT(clock_warnings(late), IsEmpty());
}

TEST(CompareTimes, WarnsOfPosesOfAnotherClock) {
  Drive drive = drive_with_clocks(2, 0);
  std::vector<StampedPose> poses;
  for (const Frame& frame : drive.frames) poses.push_back({frame.time_ns + 37 * kOneSecondNs, SE3()});
  drive.poses = Trajectory(poses);
  EXPECT_EQ(describe_unposed(drive), "no given pose near frames 0-19");
  EXPECT_THAT(clock_warnings(drive), ElementsAre(AllOf(HasSubstr("the poses are from 1037.00 s to 1038.90 s"),
                                                       HasSubstr("37.00 s ahead"), HasSubstr("add -37.00 s"))));
  for (StampedPose& pose : poses) pose.time_ns -= 37 * kOneSecondNs;
  drive.poses = Trajectory(poses);
  EXPECT_FALSE(describe_unposed(drive));
  EXPECT_THAT(clock_warnings(drive), IsEmpty());
}

}  // namespace
}  // namespace dvi::datasets
