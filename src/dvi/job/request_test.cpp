#include "dvi/job/request.h"

#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::job {
namespace {

using testing::StartsWith;
using testing::ThrowsMessage;

Job make_job(std::vector<Assignment> assignments, const fs::path& config = {}) {
  return Request{config.string(), std::move(assignments)}.job("", "", {});
}

TEST(Request, WithoutAnyOptionsTheDefaultsHold) { EXPECT_EQ(make_job({}).table().dump_toml(), Job().table().dump_toml()); }

TEST(Request, SetBeatsTheFileAndTheFileTheDefaults) {
  const TempFolder folder;
  const Job job =
      make_job({{"regularize.window", "9"}}, folder.write("dvi.toml", "[regularize]\niterations = 33\nwindow = 7\n"));
  EXPECT_EQ(job.options.regularize.iterations, 33);
  EXPECT_EQ(job.options.regularize.window, 9);
}

TEST(Request, MethodOfTheFileYieldsToItsOwnOptionsAndToTheCommandLine) {
  const TempFolder folder;
  const fs::path config = folder.write("dvi.toml", "[job]\nmethod = \"paper\"\n[stages]\nexposure = true\n");
  const Job from_file = make_job({}, config);
  EXPECT_EQ(from_file.method, Method::paper);
  EXPECT_TRUE(from_file.options.exposure.enabled) << "said by the file";
  EXPECT_TRUE(from_file.options.regularize.enabled) << "said by the method that the file names";
  for (const char* option : {"--method", "job.method"}) {
    const Job from_line = make_job({{option, "flow"}}, config);
    EXPECT_EQ(from_line.method, Method::flow);
    EXPECT_FALSE(from_line.options.smooth.enabled);
  }
}

TEST(Request, CommandLineNamesTheDataAndKeepsTheRestOfTheFile) {
  const TempFolder folder;
  const fs::path config = folder.write("dvi.toml", "[job]\nframes = \"1:9\"\ncamera = \"left\"\nremove = \"all\"\n");
  const Job job = Request{config.string(), {{"--frames", "2:3"}}}.job("out", "drive", {"other"});
  EXPECT_EQ(job.read.frames, "2:3");
  EXPECT_EQ(job.read.camera, "left");
  EXPECT_EQ(job.read.remove, Remove::all);
  EXPECT_EQ(job.out, "out");
}

TEST(Request, PathsThatExistBecomeAbsolute) {
  const TempFolder folder;
  folder.write("drive/dvi.toml", "");
  folder.write("labels", "");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path);
  const Job job = Request{"", {{"--masks", "labels"}, {"--poses", "auto"}}}.job("out", "./drive/", {"drive", "nowhere"});
  const fs::path here = fs::current_path();
  fs::current_path(before);
  EXPECT_EQ(fs::path(job.target), here / "drive/");
  EXPECT_EQ(job.sources, (std::vector<std::string>{(here / "drive").string(), "nowhere"}));
  EXPECT_EQ(to_string(job.read.masks), "labels");
  EXPECT_EQ(to_string(job.read.poses), "auto");
}

TEST(Request, DetectorAndMasksAreIndependent) {
  const TempFolder folder;
  const fs::path config = folder.write("job.toml", "[job]\nmasks = \"a/folder\"\ndetector = \"net.onnx\"\n");
  const Job from_file = make_job({}, config);
  EXPECT_EQ(from_file.read.detector, "net.onnx");
  EXPECT_EQ(to_string(from_file.read.masks), "a/folder");
  const Job other = make_job({{"--masks", "labels"}}, config);
  EXPECT_EQ(other.read.detector, "net.onnx");
  EXPECT_EQ(to_string(other.read.masks), "labels");
}

TEST(Request, MasksAreAListOfSources) {
  const TempFolder folder;
  const std::vector<std::string> list{"white:a/folder", "found", "b.json"};
  const std::string text = R"(["white:a/folder", "found", "b.json"])";
  const fs::path config = folder.write("job.toml", "[job]\nmasks = " + text + "\n");
  for (const Job& job : {make_job({}, config), make_job({{"--masks", list}}), make_job({{"job.masks", text}})}) {
    ASSERT_EQ(job.read.masks.size(), 3U);
    EXPECT_EQ(job.read.masks[0].path, "a/folder");
    EXPECT_EQ(job.read.masks[0].polarity, labels::Polarity::white);
    EXPECT_EQ(job.read.masks[1].kind, MasksFrom::Kind::found);
    EXPECT_EQ(to_string(job.read.masks), "white:a/folder found b.json");
  }
  EXPECT_EQ(make_job({}).read.masks, std::vector<MasksFrom>{MasksFrom{}});
  EXPECT_THROW(make_job({}, folder.write("bad.toml", "[job]\nmasks = 3\n")), UsageError);
}

TEST(Request, AssignmentsMustNameAnOptionAndFitIt) {
  for (const Assignment& bad : std::vector<Assignment>{{"depth.nothing", "1"},
                                                       {"regularize.window", "4"},
                                                       {"regularize.iterations", "much"},
                                                       {"job.topics", "[1]"},
                                                       {"job.camera", std::vector<std::string>{"a", "b"}}})
    EXPECT_THROW(make_job({bad}), UsageError) << bad.option;
  EXPECT_THAT([] { make_job({{"--method", "magic"}}); },
              ThrowsMessage<UsageError>(StartsWith("--method magic: must be one of dvi, paper")));
  EXPECT_THAT([] { make_job({{"job.method", "magic"}}); },
              ThrowsMessage<UsageError>(StartsWith("option job.method = 'magic': must be one of dvi, paper")));
}

TEST(Request, RemoveTakesTheBritishSpelling) {
  EXPECT_EQ(make_job({{"job.remove", "all"}, {"--remove", "labelled"}}).read.remove, Remove::labeled);
}

TEST(Request, FramesAreARangeOrOneFrame) {
  const FrameRange range = parse_frames("3:9"), one = parse_frames("272");
  EXPECT_EQ(range.first, 3);
  EXPECT_EQ(range.last, 9);
  EXPECT_EQ(one.first, 272);
  EXPECT_EQ(one.last, 272);
  for (const char* text : {"9:3", "three", "3:", ":3", "3:4:5", "3-4", ""})
    EXPECT_THROW(parse_frames(text), UsageError) << text;
}

}  // namespace
}  // namespace dvi::job
