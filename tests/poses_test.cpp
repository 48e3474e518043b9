#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <sstream>

#include <nlohmann/json.hpp>

#include "dvi/geometry/se3.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class Poses : public ProgramTest {
 protected:
  /// Reads world_from_lidar of each scan, the last 12 numbers of each line.
  std::vector<SE3> read(const fs::path& file) const {
    std::vector<SE3> poses;
    for (const std::string& line : read_lines(folder / file)) {
      std::istringstream in(line);
      std::vector<std::string> words{std::istream_iterator<std::string>(in), {}};
      if (words.size() < 12 || words[0][0] == '#') continue;
      SE3 pose;
      for (std::size_t k = 0; k < 12; ++k) {
        const double v = std::stod(words[words.size() - 12 + k]);
        (k % 4 == 3 ? pose.t[static_cast<int>(k / 4)] : pose.R(static_cast<int>(k / 4), static_cast<int>(k % 4))) = v;
      }
      poses.push_back(pose);
    }
    return poses;
  }

  /// Returns the maximum distance in meters between two trajectories, each relative to its first pose.
  static double max_distance_m(const std::vector<SE3>& a, const std::vector<SE3>& b) {
    double worst = a.size() == b.size() ? 0 : INFINITY;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
      worst = std::max(worst, ((a[0].inverse() * a[i]).t - (b[0].inverse() * b[i]).t).norm());
    return worst;
  }

  nlohmann::json map(const std::string& drive, const std::string& options) const {
    const Result result = dvi("map " + drive + " -o out --json --quiet --trajectory kitti " + options);
    EXPECT_EQ(result.code, 0) << result.err;
    return nlohmann::json::parse(result.out)["poses"];
  }

  /// Moves the given poses by `meters`, in alternating directions.
  void shake(const std::string& drive, double meters) const {
    std::string text;
    int line_number = 0;
    for (const std::string& line : read_lines(folder / drive / "poses.txt")) {
      const std::size_t last = line.rfind(' ');
      const double z = std::stod(line.substr(last)) + (line_number++ % 2 == 0 ? meters : -meters);
      text += line.substr(0, last) + " " + std::to_string(z) + "\n";
    }
    write_file(folder / drive / "poses.txt", text);
  }
};

TEST_F(Poses, FromScansFollowTheTruth) {
  small_drive();
  const nlohmann::json report = map("drive", "--poses loam");
  EXPECT_EQ(report["from"], "loam");
  EXPECT_EQ(report["odometry"]["scans"].size(), 6);
  EXPECT_LT(report["odometry"]["drift"]["lag_correction"]["largest_m"], 0.05);
  EXPECT_TRUE(report["odometry"]["drift"]["given_over_10_m"].is_null()) << "the drive is shorter";
  std::vector<std::string> stages;
  const nlohmann::json whole = nlohmann::json::parse(read_file(folder / "out/map.json"));
  for (const auto& stage : whole["cost"]["stages"]) {
    stages.push_back(stage["stage"]);
    EXPECT_GE(stage["cpu_seconds_per_scan"], 0);
  }
  EXPECT_THAT(stages, testing::ElementsAre("read", "plausibility", "odometry", "loops", "sharpness", "traffic", "complete",
                                           "map", "carve", "normals", "write"));
  EXPECT_LT(max_distance_m(read("out/trajectory.txt"), read("drive/poses.txt")), 0.03);
  ASSERT_EQ(dvi("map drive -o tum --quiet --poses loam --trajectory tum").code, 0);
  EXPECT_EQ(read_lines(folder / "tum/trajectory.txt").size(), 6);
  EXPECT_EQ(dvi("map drive -o out --trajectory evo").code, 2);
}

TEST_F(Poses, AutoKeepsExactPosesAndReplacesNoisyPoses) {
  small_drive();
  const std::vector<SE3> truth = read("drive/poses.txt");
  EXPECT_EQ(map("drive", "")["from"], "given");
  EXPECT_LT(max_distance_m(read("out/trajectory.txt"), truth), 1e-6);
  shake("drive", 0.05);
  const nlohmann::json report = map("drive", "");
  EXPECT_EQ(report["from"], "loam");
  EXPECT_GT(report["sharpness"]["given"]["ground_m"], 0.02);
  EXPECT_LT(report["sharpness"]["loam"]["ground_m"], 0.01);
  EXPECT_LT(max_distance_m(read("out/trajectory.txt"), truth), 0.03);
  EXPECT_EQ(map("drive", "--poses given")["from"], "given");
}

TEST_F(Poses, InvertedPosesCauseAWarningAndAreNotUsed) {
  small_drive("drive", "", 16);
  const std::vector<SE3> truth = read("drive/poses.txt");
  std::string text;
  std::size_t i = 0;
  for (const std::string& line : read_lines(folder / "drive/poses.txt")) {
    const SE3 inverse = truth[i++].inverse();
    text += line.substr(0, line.find(' '));
    for (int k = 0; k < 12; ++k) text += " " + std::to_string(k % 4 == 3 ? inverse.t[k / 4] : inverse.R(k / 4, k % 4));
    text += "\n";
  }
  write_file(folder / "drive/poses.txt", text);
  EXPECT_EQ(map("drive", "")["from"], "loam");
  EXPECT_LT(max_distance_m(read("out/trajectory.txt"), truth), 0.03);
  EXPECT_THAT(dvi("check drive --quiet").out, HasSubstr("seem to be inverted"));
}

TEST_F(Poses, AreEstimatedIfNoneAreGiven) {
  small_drive();
  const std::vector<SE3> truth = read("drive/poses.txt");
  fs::remove(folder / "drive/poses.txt");
  EXPECT_EQ(map("drive", "")["from"], "loam");
  EXPECT_LT(max_distance_m(read("out/trajectory.txt"), truth), 0.03);
  EXPECT_THAT(dvi("check drive --quiet").out, HasSubstr("loam poses"));
  EXPECT_EQ(dvi("map drive -o given --quiet --poses given").code, 3);
}

TEST_F(Poses, OfDrivesInOneWorldRemainAligned) {
  small_drive("one");
  small_drive("two", "--day 2");
  shake("two", 0.05);
  const Result result = dvi("run one two -o out --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json drives = nlohmann::json::parse(result.out)["drives"];
  EXPECT_EQ(drives[0]["poses"]["from"], "given");
  EXPECT_EQ(drives[1]["poses"]["from"], "loam");
}

TEST_F(Poses, OutliersCauseAWarningAndAreLeftOut) {
  small_drive();
  const std::vector<SE3> truth = read("drive/poses.txt");
  std::string text;
  int line_number = 0;
  for (const std::string& line : read_lines(folder / "drive/poses.txt"))
    text += line_number++ == 2 ? line.substr(0, line.rfind(' ')) + " 4189970\n" : line + "\n";
  write_file(folder / "drive/poses.txt", text);
  const Result check = dvi("check drive --quiet");
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("1 of 6 given poses are outliers and are ignored"));
  for (const std::string poses : {"auto", "given"}) {
    map("drive", "--poses " + poses);
    EXPECT_LT(max_distance_m(read("out/trajectory.txt"), truth), 0.05) << poses;
  }
}

TEST_F(Poses, OfAnotherClockAreRefusedWithTheDifference) {
  small_drive();
  ASSERT_EQ(dvi("map drive -o out --quiet --poses given --trajectory tum").code, 0);
  std::string text;
  for (const std::string& line : read_lines(folder / "out/trajectory.txt"))
    text += std::to_string(std::stod(line) + 37) + line.substr(line.find(' ')) + "\n";
  write_file(folder / "late.txt", text);
  for (const std::string command : {"check drive", "run drive -o refused"}) {
    const Result result = dvi(command + " --quiet --poses late.txt");
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.err, testing::AllOf(HasSubstr("late.txt"), HasSubstr("no given pose near frames 0-5"),
                                           HasSubstr("37.00 s ahead (TAI against UTC)"), HasSubstr("add -37.00 s")));
  }
}

// The gap has more than a second without images and scans.
TEST_F(Poses, AcrossAGapAreNotGuessed) {
  small_drive("drive", "", 24);
  for (int i = 6; i < 18; ++i) {
    const std::string name = std::string(i < 10 ? "00000" : "0000") + std::to_string(i);
    for (const std::string& file : {"images/front/" + name + ".png", "masks/front/" + name + ".png", "lidar/" + name + ".bin"})
      fs::remove(folder / "drive" / file);
  }
  fs::rename(folder / "drive/poses.txt", folder / "truth.txt");
  const std::vector<SE3> truth = read("truth.txt");
  const Result result = dvi("map drive -o out --trajectory kitti");
  ASSERT_EQ(result.code, 0) << result.err;
  const std::vector<SE3> found = read("out/trajectory.txt");
  ASSERT_EQ(found.size(), 12U);
  const double step_m = (found[6].t - found[5].t).norm();
  if (step_m > 1000)
    EXPECT_THAT(result.err, HasSubstr("no scan for 1.3 s, between frames 5 and 18, and neither poses nor scans"));
  else
    EXPECT_NEAR(step_m, (truth[18].t - truth[5].t).norm(), 0.5);
}

}  // namespace
}  // namespace dvi
