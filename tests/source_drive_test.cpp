#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class SourceDrive : public ProgramTest {
 protected:
  /// Makes a drive without poses.
  fs::path without_poses(const std::string& name, const std::string& options) const {
    const fs::path drive = small_drive(name, options, kFrames);
    fs::remove(drive / "poses.txt");
    return drive;
  }

  nlohmann::json drives_of(const std::string& out) const {
    return nlohmann::json::parse(read_file(folder / out / "report.json"))["drives"];
  }

  std::string refused(const std::string& arguments) const {
    const Result result = dvi("run " + arguments + " -o out --quiet");
    EXPECT_EQ(result.code, 3) << result.out;
    EXPECT_FALSE(fs::exists(folder / "out/frames"));
    return result.err;
  }

  static constexpr int kFrames = 12;
};

TEST_F(SourceDrive, IsRegisteredByItsScansAlone) {
  small_drive("drive", "--truck", kFrames);
  without_poses("other", "--day 2");
  const Result result = dvi("run drive other -o out --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("other: 100 % of its scans overlap"));
  const nlohmann::json drives = drives_of("out");
  EXPECT_TRUE(drives[0]["registration"].is_null());
  const nlohmann::json& placed = drives[1]["registration"];
  EXPECT_LT(placed["bound_m"], 0.06);
  EXPECT_LT(placed["bound_deg"], 0.15);
  EXPECT_GT(placed["overlap"], 0.9);
  // The lanes are 3.5 m apart, and the LiDAR of both days starts at nearly the same place along the street.
  EXPECT_NEAR(placed["target_from_source"][1][3], -3.42, 0.06);
  EXPECT_NEAR(placed["target_from_source"][0][3], 0.01, 0.06);
  EXPECT_EQ(dvi("audit out drive other --quiet").code, 0);
}

TEST_F(SourceDrive, GivenPosesAreRefinedUnlessPosesIsGiven) {
  small_drive("drive", "--truck", kFrames);
  small_drive("other", "--day 2", kFrames);
  ASSERT_EQ(dvi("run drive other -o refined --quiet").code, 0);
  EXPECT_FALSE(drives_of("refined")[1]["registration"].is_null());
  ASSERT_EQ(dvi("run drive other -o kept --poses given --quiet").code, 0);
  EXPECT_TRUE(drives_of("kept")[1]["registration"].is_null());
}

TEST_F(SourceDrive, FramesFarFromTheTargetAreNotRead) {
  small_drive("drive", "--truck", kFrames);
  const fs::path other = small_drive("other", "--day 2", kFrames);
  std::string poses;
  int line_number = 0;
  for (const std::string& line : read_lines(other / "poses.txt")) {
    std::istringstream words(line);
    std::vector<std::string> pose{std::istream_iterator<std::string>(words), {}};
    const bool far = line_number++ >= kFrames / 2;
    if (far) pose.at(4) = "5000";  // meters ahead
    if (far) write_file(other / "images/front" / (pose[0] + ".png"), "damaged");
    poses += fmt::format("{}\n", fmt::join(pose, " "));
  }
  write_file(other / "poses.txt", poses);
  const Result result = dvi("run drive other -o out --poses given");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("other: 6 of 12 frames are near drive"));
  EXPECT_GT(nlohmann::json::parse(read_file(folder / "out/report.json"))["hole"]["copied_elsewhere"], 100);
  EXPECT_EQ(dvi("audit out drive other --quiet").code, 0);
}

TEST_F(SourceDrive, AnotherStreetIsRefused) {
  small_drive("drive", "--truck", kFrames);
  without_poses("other", "--day 2 --seed 2");
  EXPECT_THAT(refused("drive other"),
              testing::AllOf(HasSubstr("other: "), HasSubstr("landmarks are inliers"), HasSubstr("poses in one world")));
}

TEST_F(SourceDrive, TheTargetIsNotItsOwnSource) {
  small_drive("drive", "", kFrames);
  fs::copy(folder / "drive", folder / "copy", fs::copy_options::recursive);
  EXPECT_THAT(refused("drive drive"), HasSubstr("given as its own source"));
  EXPECT_THAT(refused("drive copy"), HasSubstr("given as its own source"));
}

TEST_F(SourceDrive, WithoutPosesAndScansItIsRefused) {
  small_drive("drive", "", kFrames);
  fs::remove_all(without_poses("other", "--day 2") / "lidar");
  EXPECT_THAT(refused("drive other"), HasSubstr("has neither poses nor scans"));
}

}  // namespace
}  // namespace dvi
