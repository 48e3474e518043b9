#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "dvi/core/version.h"
#include "dvi/job/job.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;
using testing::Not;
using CommandLine = ProgramTest;

TEST_F(CommandLine, PrintsVersionHelpAndFormats) {
  EXPECT_EQ(dvi("version").out, std::string("dvi ") + kVersion + "\n");
  EXPECT_EQ(dvi("--version").code, 0);
  EXPECT_EQ(dvi("--help").code, 0);
  EXPECT_EQ(dvi("run --help").code, 0);
  const std::string formats = dvi("formats").out;
  for (const char* format : {"folder", "kitti-raw", "apolloscape", "7-scenes", "tum-rgbd", "scannet"})
    EXPECT_THAT(formats, HasSubstr(format));
}

TEST_F(CommandLine, UsageErrorsHaveExitCode2) {
  for (const char* arguments : {"",
                                "fly",
                                "run",
                                "run drive",
                                "run drive -o out --frames 3:",
                                "run drive -o out --frames 9:1",
                                "demo --frames a",
                                "run drive -o out --set depth.nothing=1",
                                "run drive -o out --set depth.median_px=99",
                                "run drive -o out --set regularize.window=4",
                                "run drive -o out --set depth.median_px=4",
                                "run drive -o out --set lidar.min_range_m=20 --set lidar.max_range_m=10",
                                "run drive -o out --set odometry.min_range_m=3",
                                "run drive -o out --method magic",
                                "run drive -o out --remove none",
                                "run drive -o out --polarity gray",
                                "run drive -o out --poses loam-of-tomorrow --set x",
                                "run drive -o out --config missing.toml",
                                "synth",
                                "eval out --ignore i",
                                "eval out --truth t --external net",
                                "synth -o s --frames none"}) {
    const Result result = dvi(arguments);
    EXPECT_EQ(result.code, 2) << arguments << ": " << result.err;
    EXPECT_THAT(result.err, testing::StartsWith("dvi: ")) << arguments;
    EXPECT_TRUE(result.out.empty()) << arguments;
    EXPECT_FALSE(fs::exists(folder / "out")) << arguments;
  }
}

TEST_F(CommandLine, DumpedOptionsCanBeReadBack) {
  const Result dump = dvi("config dump --all --set regularize.window=3");
  EXPECT_THAT(dump.out, HasSubstr("window = 3"));
  write_file(folder / "all.toml", dump.out);
  EXPECT_EQ(dvi("config dump --all --config all.toml").out, dump.out);
  EXPECT_THAT(dvi("config dump --method paper").out, HasSubstr("method = 'paper'"));
  EXPECT_THAT(dvi("config dump").out, Not(HasSubstr("[regularize]"))) << "developer options need --all";
}

TEST_F(CommandLine, AShortFormIsItsOptionInSetAndInAFile) {
  const std::string defaults = dvi("config dump --all").out;
  job::Job job;
  const OptionTable table = job.table();
  for (const Option& option : table.options()) {
    if (option.flag.empty()) continue;
    const std::string value = !option.choices.empty() ? option.choices.back() : option.name() == "job.frames" ? "1:2" : "a=b";
    const bool list = std::holds_alternative<std::vector<std::string>>(option.get());
    const std::string toml = list ? "['" + value + "']" : "'" + value + "'";
    write_file(folder / "one.toml", fmt::format("[{}]\n{} = {}\n", option.section, option.key, toml));
    const Result flag = dvi(fmt::format("config dump --all {} {}", option.flag, value));
    EXPECT_EQ(flag.code, 0) << flag.err;
    EXPECT_NE(flag.out, defaults) << option.flag;
    EXPECT_EQ(dvi(fmt::format("config dump --all --set {}={}", option.name(), value)).out, flag.out) << option.name();
    EXPECT_EQ(dvi("config dump --all --config one.toml").out, flag.out) << option.name();
  }
}

TEST_F(CommandLine, UnknownOptionsOfAFileAreRefusedWithTheNearest) {
  write_file(folder / "old.toml", "[smooth]\nreplace_outlier = true\n");
  const Result result = dvi("run drive -o out --config old.toml");
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err,
              HasSubstr("old.toml: there is no option 'smooth.replace_outlier' (did you mean 'smooth.replace_outliers'?)"));
}

TEST_F(CommandLine, CheckDescribesADrive) {
  small_drive();
  const Result text = dvi("check drive --quiet");
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, testing::AllOf(HasSubstr("ready for dvi run"), Not(HasSubstr("coverage"))));
  const nlohmann::json j = nlohmann::json::parse(dvi("check drive --quiet --json").out);
  EXPECT_EQ(j["format"], "folder");
  EXPECT_FALSE(j.contains("coverage"));
  EXPECT_EQ(j["frames"]["count"], 6);
  EXPECT_EQ(j["scans"]["count"], 6);
  EXPECT_EQ(j["frames"]["with_pose"], 6);
  EXPECT_NEAR(j["frames"]["rate_hz"], 10, 0.01);
}

TEST_F(CommandLine, ASingleFrameIsReported) {
  small_drive();
  const Result result = dvi("check drive --frames 3 --json");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["frames"]["count"], 1);
  EXPECT_THAT(result.err, HasSubstr("note: frame 3 only (--frames A:B for a range)"));
}

TEST_F(CommandLine, MapWritesPosesAndPoints) {
  small_drive();
  const Result result = dvi("map drive -o map --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json j = nlohmann::json::parse(result.out);
  EXPECT_GT(j["points"], 1000);
  EXPECT_EQ(j["scans"], 6);
  EXPECT_EQ(read_lines(folder / "map/poses.txt").size(), 6);
  EXPECT_EQ(read_lines(folder / "map/times.txt").size(), 6);
  EXPECT_EQ(read_file(folder / "map/map.ply").substr(0, 4), "ply\n");
}

TEST_F(CommandLine, MapDoesNotWriteToItsInputs) {
  const fs::path drive = small_drive();
  const auto before = ::dvi::contents(drive);
  for (const char* arguments : {"-o drive", "-o .", "-o drive/map", "--poses drive/poses.txt -o drive/poses.txt/map",
                                "--masks drive/masks/front -o drive/masks"}) {
    const Result refused = dvi(std::string("map drive --quiet ") + arguments);
    EXPECT_EQ(refused.code, 3) << arguments;
    EXPECT_THAT(refused.err, HasSubstr("input of the run")) << arguments;
  }
  EXPECT_EQ(shell("cd drive && " DVI_PROGRAM " map . --quiet -o map").code, 3);
  EXPECT_TRUE(::dvi::contents(drive) == before);
}

TEST_F(CommandLine, EvalScoresAResult) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const Result result = dvi("eval out --truth drive/truth --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(nlohmann::json::parse(result.out).is_object());
  EXPECT_THAT(dvi("eval out --truth drive/truth --quiet").out, HasSubstr("PSNR"));
  EXPECT_THAT(dvi("eval out --truth drive/truth --json-log").err, HasSubstr(R"("stage":"eval","total":6)"));
  EXPECT_EQ(dvi("eval out --truth nowhere --quiet").code, 3);
  EXPECT_EQ(dvi("eval drive --truth drive/truth --quiet").code, 3);
}

TEST_F(CommandLine, DemoRunsOnAGivenDrive) {
  small_drive();
  const Result result = dvi("demo drive -o demo --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("demo/result/video.mp4"));
  EXPECT_TRUE(fs::exists(folder / "demo/result/contact.png"));
}

TEST_F(CommandLine, ProgressGoesToStderrOnly) {
  small_drive();
  const Result lines = dvi("run drive -o out");
  EXPECT_THAT(lines.err, HasSubstr("fill"));
  const Result json = dvi("run drive -o out2 --json-log");
  std::istringstream stream(json.err);
  int events = 0;
  for (std::string line; std::getline(stream, line); ++events) EXPECT_TRUE(nlohmann::json::accept(line)) << line;
  EXPECT_GT(events, 4);
  EXPECT_TRUE(dvi("run drive -o out3 --quiet").err.empty());
}

TEST_F(CommandLine, AnInterruptHasExitCode130) {
  small_drive();
  // The signal is sent after the program reports that it has read the drive, when most of the work remains.
  const Result result = shell("{ " + std::string(DVI_PROGRAM) +
                              " run drive -o out --threads 1 2> log & pid=$!; until grep -q read log; do sleep 0.01; done; "
                              "kill -INT $pid; wait $pid; code=$?; cat log >&2; exit $code; }");
  EXPECT_EQ(result.code, 130);
  EXPECT_THAT(result.err, HasSubstr("interrupted; no part is finished; the same command starts again"));
}

}  // namespace
}  // namespace dvi
