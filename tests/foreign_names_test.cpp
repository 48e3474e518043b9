// Runs on paths and recordings as written by other systems and programs.

#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/core/files.h"
#include "dvi/testing/find_recording.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ForeignNames : public ProgramTest {};

// Folders and images have names in Latin-1, while TOML and JSON are UTF-8.
TEST_F(ForeignNames, NeedNotBeUtf8) {
  const std::string latin = fmt::format("Stra{}e", '\xDF');
  const fs::path drive = small_drive(latin, "", 4);
  fs::remove(drive / "boxes.json");
  std::string times = read_file(drive / "times/front.txt");
  for (int i = 0; i < 4; ++i) {
    const std::string name = fmt::format("{:06d}", i), image = fmt::format("f{}{}", '\xFC', i);
    for (const char* kind : {"images/front", "masks/front"})
      fs::rename(drive / kind / (name + ".png"), drive / kind / (image + ".png"));
    times.replace(times.find(name), name.size(), image);
  }
  write_file(drive / "times/front.txt", times);
  const Result run = dvi(fmt::format("run {0} -o out{0} --quiet --frames 0:1", latin));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(read_file(folder / ("out" + latin) / "dvi.toml"), HasSubstr("Stra%DFe"));
  const Result again = dvi(fmt::format("run --config out{}/dvi.toml -o again --quiet", latin));
  ASSERT_EQ(again.code, 0) << again.err;
  const std::vector<fs::path> frames = list_files(folder / "again/frames", {".png"});
  ASSERT_EQ(frames.size(), 2U);
  for (const fs::path& frame : frames)
    EXPECT_EQ(read_file(frame), read_file(folder / ("out" + latin) / "frames" / frame.filename()));
  for (const std::string& command :
       {fmt::format("audit out{0} {0}", latin), fmt::format("export colmap out{} -o model", latin)}) {
    const Result result = dvi(command);
    EXPECT_EQ(result.code, 0) << result.err;
  }
}

// The published form of the benchmark has times in scientific notation and no masks.
TEST_F(ForeignNames, KittiOdometryRunsWithoutChanges) {
  const fs::path path = find_recording("foreign_files/kitti_odometry");
  DVI_SKIP_WITHOUT(path);
  const Result parent = dvi("check " + path.string());
  EXPECT_EQ(parent.code, 3);
  EXPECT_THAT(parent.err, HasSubstr("did you mean " + (path / "sequences/04").string()));
  const Result run = dvi(fmt::format("run {} -o out --quiet", (path / "sequences/04").string()));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(list_files(folder / "out/frames", {".png"}).size(), 3U);
}

TEST_F(ForeignNames, CheckWarnsOfKitti360TimesOfAnotherExcerpt) {
  const fs::path path = find_recording("foreign_files/kitti_360/data_2d_raw/2013_05_28_drive_0007_sync");
  DVI_SKIP_WITHOUT(path);
  const Result check = dvi(fmt::format("check {}", path.string()));
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, AllOf(HasSubstr("frames   3 (3000:3002), 9.6 Hz"), HasSubstr("it belongs to another excerpt")));
}

}  // namespace
}  // namespace dvi
