#include "dvi/cli/job_options.h"

#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::cli {
namespace {

TEST(JobOptions, WithoutAnyTheDefaultsHold) {
  job::Job job = JobOptions().job("", "", {});
  EXPECT_EQ(job.table().dump_toml(), job::Job().table().dump_toml());
}

TEST(JobOptions, SetBeatsTheFileAndTheFileTheDefaults) {
  const TempFolder folder;
  JobOptions options;
  options.config = folder.write("dvi.toml", "[regularize]\niterations = 33\nwindow = 7\n").string();
  options.set = {"regularize.window=9"};
  const job::Job job = options.job("", "", {});
  EXPECT_EQ(job.options.regularize.iterations, 33);
  EXPECT_EQ(job.options.regularize.window, 9);
}

TEST(JobOptions, MethodOfTheFileYieldsToItsOwnOptionsAndToTheCommandLine) {
  const TempFolder folder;
  const std::string config = folder.write("dvi.toml", "[job]\nmethod = \"paper\"\n[stages]\nexposure = true\n").string();
  JobOptions options;
  options.config = config;
  const job::Job from_file = options.job("", "", {});
  EXPECT_EQ(from_file.method, job::Method::paper);
  EXPECT_TRUE(from_file.options.exposure.enabled) << "said by the file";
  EXPECT_TRUE(from_file.options.regularize.enabled) << "said by the method that the file names";
  options.method = "flow";
  const job::Job from_line = options.job("", "", {});
  EXPECT_EQ(from_line.method, job::Method::flow);
  EXPECT_FALSE(from_line.options.smooth.enabled);
  options.method = "magic";
  EXPECT_THROW(options.job("", "", {}), UsageError);
}

TEST(JobOptions, CommandLineNamesTheDataAndKeepsTheRestOfTheFile) {
  const TempFolder folder;
  JobOptions options;
  options.config = folder.write("dvi.toml", "[job]\nframes = \"1:9\"\ncamera = \"left\"\nremove = \"all\"\n").string();
  options.frames = "2:3";
  const job::Job job = options.job("out", "drive", {"other"});
  EXPECT_EQ(job.read.frames, "2:3");
  EXPECT_EQ(job.read.camera, "left");
  EXPECT_EQ(job.read.remove, job::Remove::all);
  EXPECT_EQ(job.out, "out");
  options.remove = "everything";
  EXPECT_THROW(options.job("", "", {}), UsageError);
}

TEST(JobOptions, PathsThatAreThereBecomeAbsolute) {
  const TempFolder folder;
  folder.write("drive/dvi.toml", "");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path);
  JobOptions options;
  options.masks = "labels";
  options.poses = "auto";
  const job::Job job = options.job("out", "./drive/", {"drive", "nowhere"});
  const fs::path here = fs::current_path();
  fs::current_path(before);
  EXPECT_EQ(fs::path(job.target), here / "drive/");
  EXPECT_EQ(job.sources, (std::vector<std::string>{(here / "drive").string(), "nowhere"}));
  EXPECT_EQ(job::to_string(job.read.masks), "labels");
  EXPECT_EQ(job::to_string(job.read.poses), "auto");
}

TEST(JobOptions, DetectorAndMasksReplaceEachOtherFromAFile) {
  const TempFolder folder;
  JobOptions options;
  options.config = folder.write("masks.toml", "[job]\nmasks = \"a/folder\"\n");
  options.detector = "net.onnx";
  const job::Job detected = options.job("", "", {});
  EXPECT_EQ(detected.read.detector, "net.onnx");
  EXPECT_EQ(job::to_string(detected.read.masks), "auto");
  options = {};
  options.config = folder.write("detector.toml", "[job]\ndetector = \"net.onnx\"\n");
  EXPECT_EQ(options.job("", "", {}).read.detector, "net.onnx");
  options.masks = "labels";
  EXPECT_EQ(options.job("", "", {}).read.detector, "");
  options.detector = "net.onnx";
  EXPECT_THROW(options.job("", "", {}), UsageError);
}

TEST(JobOptions, SetMustNameAnOptionAndFitIt) {
  JobOptions options;
  for (const char* assignment :
       {"depth.nothing=1", "regularize.iterations", "regularize.window=4", "regularize.iterations=much"}) {
    options.set = {assignment};
    EXPECT_THROW(options.job("", "", {}), UsageError) << assignment;
  }
}

TEST(JobOptions, FramesAreARangeOrOneFrame) {
  const FrameRange range = job::parse_frames("3:9"), one = job::parse_frames("272");
  EXPECT_EQ(range.first, 3);
  EXPECT_EQ(range.last, 9);
  EXPECT_EQ(one.first, 272);
  EXPECT_EQ(one.last, 272);
  for (const char* text : {"9:3", "three", "3:", ":3", "3:4:5", "3-4", ""})
    EXPECT_THROW(job::parse_frames(text), UsageError) << text;
}

}  // namespace
}  // namespace dvi::cli
