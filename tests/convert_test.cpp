#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/files.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class Convert : public ProgramTest {};

TEST_F(Convert, ARunOfTheCopyWritesTheSameFrames) {
  small_drive("drive", "--side-cameras");
  const Result convert = dvi("convert drive -o copy --quiet");
  ASSERT_EQ(convert.code, 0) << convert.err;
  EXPECT_THAT(convert.out, HasSubstr("from folder frames 0:5"));
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  ASSERT_EQ(dvi("run copy -o out_of_copy --quiet").code, 0);
  for (const char* part : {"frames", "provenance", "masks", "depth"})
    EXPECT_TRUE(contents(folder / "out" / part) == contents(folder / "out_of_copy" / part)) << part;
}

TEST_F(Convert, ConvertsARangeOfFrames) {
  small_drive();
  ASSERT_EQ(dvi("convert drive -o part --frames 2:4 --quiet").code, 0);
  EXPECT_EQ(list_files(folder / "part/images/front", {".png"}).size(), 3U);
  const Result check = dvi("check part --quiet");
  EXPECT_THAT(check.out, HasSubstr("(2:4)"));
  const Result again = dvi("convert drive -o part --quiet");
  EXPECT_EQ(again.code, 3);
  EXPECT_THAT(again.err, HasSubstr("part"));
  EXPECT_EQ(dvi("convert drive -o other --frames 7:9").code, 3);
  EXPECT_FALSE(fs::exists(folder / "other"));
}

TEST_F(Convert, InitWritesADraftOfTheConfiguration) {
  const fs::path drive = small_drive();
  const std::string whole = read_file(drive / "dvi.toml");
  EXPECT_EQ(dvi("init drive").code, 3) << "there is one already";
  fs::remove(drive / "dvi.toml");
  const Result init = dvi("init drive");
  ASSERT_EQ(init.code, 0) << init.err;
  EXPECT_THAT(init.out, HasSubstr("K: take it from the calibration"));
  std::string draft = read_file(drive / "dvi.toml");
  EXPECT_THAT(draft, HasSubstr("size = [240, 136]"));
  EXPECT_THAT(draft, HasSubstr("rate = 10"));
  const Result unfilled = dvi("check drive");
  EXPECT_EQ(unfilled.code, 3);
  EXPECT_THAT(unfilled.err, HasSubstr("[camera.front] has no K"));
  for (const std::string key : {"K = ", "camera_from_lidar = "}) {
    const std::size_t from = whole.find("\n" + key) + 1, to = draft.find("# " + key);
    ASSERT_NE(to, std::string::npos);
    draft.replace(to, draft.find('\n', to) - to, whole.substr(from, whole.find('\n', from) - from));
  }
  write_file(drive / "dvi.toml", draft);
  EXPECT_EQ(dvi("check drive --quiet").code, 0);
}

}  // namespace
}  // namespace dvi
