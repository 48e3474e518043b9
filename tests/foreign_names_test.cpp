// Paths and recordings as other systems and programs write them, from end to end.

#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/core/files.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ForeignNames : public ProgramTest {
 protected:
  static fs::path data(const std::string& name) {
    const char* root = std::getenv("DVI_DATA");
    return fs::path(root != nullptr ? root : "/tmp/dvi-data") / "foreign_files" / name;
  }
};

// A folder that Latin-1 named; TOML and JSON hold UTF-8 only.
TEST_F(ForeignNames, OfFoldersNeedNotBeUtf8) {
  small_drive(
      "Stra\xDF"
      "e",
      "", 4);
  const Result run =
      dvi("run Stra\xDF"
          "e -o out\xDF --quiet --frames 0:1");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(read_file(folder / "out\xDF/dvi.toml"), HasSubstr("Stra%DFe"));
  const Result again = dvi("run --config out\xDF/dvi.toml -o again --quiet");
  ASSERT_EQ(again.code, 0) << again.err;
  for (const char* name : {"frames/000000.png", "frames/000001.png"})
    EXPECT_EQ(read_file(folder / "again" / name), read_file(folder / "out\xDF" / name));
  const Result audit =
      dvi("audit out\xDF Stra\xDF"
          "e");
  EXPECT_EQ(audit.code, 0) << audit.err;
}

// As the benchmark ships it: times in scientific notation, no masks.
TEST_F(ForeignNames, KittiOdometryRunsAsItIs) {
  const fs::path path = data("kitti_odometry");
  if (!fs::exists(path)) GTEST_SKIP() << path << " is not there; set DVI_DATA to the recordings";
  const Result parent = dvi("check " + path.string());
  EXPECT_EQ(parent.code, 3);
  EXPECT_THAT(parent.err, HasSubstr("did you mean " + (path / "sequences/04").string()));
  const Result run = dvi(fmt::format("run {} -o out --quiet", (path / "sequences/04").string()));
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(list_files(folder / "out/frames", {".png"}).size(), 3U);
}

TEST_F(ForeignNames, Kitti360WithTimesOfAnotherExcerptIsChecked) {
  const fs::path path = data("kitti_360/data_2d_raw/2013_05_28_drive_0007_sync");
  if (!fs::exists(path)) GTEST_SKIP() << path << " is not there; set DVI_DATA to the recordings";
  const Result check = dvi(fmt::format("check {}", path.string()));
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, AllOf(HasSubstr("frames   3 (3000:3002), 9.6 Hz"), HasSubstr("it is of another excerpt")));
}

}  // namespace
}  // namespace dvi
