#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class ReportOfARun : public ProgramTest {};

TEST_F(ReportOfARun, IsWrittenAgainIfItIsMissing) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const auto whole = contents(folder / "out");
  EXPECT_TRUE(fs::exists(folder / "out/map/map.png"));
  const std::string video = std::to_string(fs::last_write_time(folder / "out/video.mp4").time_since_epoch().count());
  fs::remove(folder / "out/report.html");
  fs::remove(folder / "out/report/before/000002.png");
  fs::remove(folder / "out/report/data_000003.js");
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_EQ(contents(folder / "out"), whole);
  EXPECT_EQ(std::to_string(fs::last_write_time(folder / "out/video.mp4").time_since_epoch().count()), video)
      << "other files are kept";
  ASSERT_EQ(dvi("eval out --truth drive/truth --quiet").code, 0);
  EXPECT_TRUE(fs::exists(folder / "out/report/truth/000000.png"));
  EXPECT_THAT(dvi("run drive -o out").err, HasSubstr("nothing to do"));
  ASSERT_EQ(dvi("report out --quiet").code, 0);
  EXPECT_EQ(contents(folder / "out"), whole) << "the report no longer contains the truth";
}

TEST_F(ReportOfARun, OfAFolderWithoutAResultIsRefused) {
  fs::create_directories(folder / "empty");
  const Result result = dvi("report empty");
  EXPECT_EQ(result.code, 3);
  EXPECT_THAT(result.err, HasSubstr("is not a result of dvi"));
  EXPECT_EQ(dvi("inspect empty 0 0 0").code, 3);
  EXPECT_EQ(dvi("inspect empty 0 0").code, 2);
  EXPECT_FALSE(fs::exists(folder / "empty/report"));
}

TEST_F(ReportOfARun, OfAnUnfinishedRunStatesIt) {
  fs::create_directories(folder / "out/.dvi");
  ASSERT_EQ(dvi("report out --quiet").code, 0);
  EXPECT_THAT(read_file(folder / "out/report/index.js"), HasSubstr("the run is not finished"));
}

}  // namespace
}  // namespace dvi
