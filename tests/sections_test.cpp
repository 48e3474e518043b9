#include <gmock/gmock.h>

#include <fstream>

#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

/// Plans drives in sections.
class Sections : public ProgramTest {
 protected:
  void expect_refused(const std::string& arguments, const std::string& reason, int code = 3) const {
    const Result refused = dvi(arguments);
    EXPECT_EQ(refused.code, code) << arguments;
    EXPECT_THAT(refused.err, HasSubstr(reason));
    EXPECT_EQ(refused.out, "");
  }
  /// Returns the pictures of all frames.
  std::map<std::string, std::string> pictures(const std::string& out) const {
    std::map<std::string, std::string> files = contents(folder / out);
    std::erase_if(files, [](const auto& file) {
      return !file.first.ends_with(".png") || file.first.starts_with(".dvi") || file.first.starts_with("map/");
    });
    return files;
  }
};

TEST_F(Sections, WhoseOverlapsAreTheWholeDriveGiveTheSameBytes) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o whole --quiet").code, 0);
  EXPECT_THAT(dvi("plan drive -o out --section 1/2 --quiet").out, HasSubstr("section 1 of 2 planned: 3 frames, 0 to 2"));
  ASSERT_EQ(dvi("plan drive -o out --section 2/2 --quiet").code, 0);
  const nlohmann::json plan = nlohmann::json::parse(dvi("join out --quiet --json").out);
  EXPECT_EQ(plan["frames"], (nlohmann::json{0, 1, 2, 3, 4, 5}));
  expect_refused("finish out --quiet", "lacks 6 of 6 frames");
  ASSERT_EQ(dvi("fill out --frames 2:4 --quiet").code, 0);
  ASSERT_EQ(dvi("fill out --quiet").code, 0);
  const Result finished = dvi("finish out --quiet --json");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(pictures("out"), pictures("whole"));
  EXPECT_EQ(read_file(folder / "out/objects.json"), read_file(folder / "whole/objects.json"));
  const nlohmann::json report = nlohmann::json::parse(finished.out);
  EXPECT_EQ(report["map"]["points"], nlohmann::json::parse(read_file(folder / "whole/report.json"))["map"]["points"]);
  EXPECT_GE(report["cost"]["frames_made"], 6);
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
  ASSERT_EQ(dvi("run drive -o inone --set job.sections=2 --quiet").code, 0);
  EXPECT_EQ(pictures("inone"), pictures("out"));
  EXPECT_THAT(dvi("run drive -o inone --set job.sections=2").err, HasSubstr("nothing to do"));
}

TEST_F(Sections, WithShortOverlapsPassTheAudit) {
  small_drive("drive", "", 24);
  const std::string options = " --set sample.max_frame_gap=3 --quiet";
  for (const char* section : {"3/3", "1/3", "2/3"})
    ASSERT_EQ(dvi("plan drive -o out --section " + std::string(section) + options).code, 0);
  ASSERT_EQ(dvi("join out --quiet").code, 0);
  ASSERT_EQ(dvi("fill out --quiet").code, 0);
  ASSERT_EQ(dvi("finish out --quiet").code, 0);
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0) << "no section copies from pixels that another one removes";
  std::ifstream poses(folder / "out/map/poses.txt");
  EXPECT_EQ(std::count(std::istreambuf_iterator<char>(poses), {}, '\n'), 24);
}

TEST_F(Sections, ThatAreMissingAreNamed) {
  small_drive();
  expect_refused("join nowhere", "does not contain plans of sections");
  expect_refused("plan drive -o out --section 3/2", "expected K/N", 2);
  expect_refused("plan drive -o out --section 0/2", "expected K/N", 2);
  expect_refused("plan drive -o out --section x", "expected K/N", 2);
  expect_refused("plan drive -o out --section 1/4 --quiet", "cannot be cut into 4 sections: at most 3", 2);
  EXPECT_FALSE(fs::exists(folder / "out"));
  ASSERT_EQ(dvi("plan drive -o out --section 1/3 --quiet").code, 0);
  expect_refused("join out --quiet", "sections 2, 3 of 3 are not planned");
  expect_refused("fill out --quiet", "does not contain a plan");
  ASSERT_EQ(dvi("plan drive -o out --section 2/3 --quiet").code, 0);
  expect_refused("join out --quiet", "section 3 of 3 is not planned");
  fs::remove(folder / "out/.dvi/sections/3/2/.dvi/plan.json");
  expect_refused("join out --quiet", "sections 2, 3 of 3 are not planned");
}

TEST_F(Sections, OfOtherOptionsProgramsOrCutsAreRefused) {
  small_drive();
  for (const char* section : {"1/2", "2/2"})
    ASSERT_EQ(dvi("plan drive -o out --section " + std::string(section) + " --quiet").code, 0);
  const std::string before = read_file(folder / "out/.dvi/sections/2/1/.dvi/stages/map.json");
  ASSERT_EQ(dvi("plan drive -o out --section 1/2 --quiet").code, 0);
  EXPECT_EQ(read_file(folder / "out/.dvi/sections/2/1/.dvi/stages/map.json"), before) << "planned twice: nothing is computed";

  ASSERT_EQ(dvi("plan drive -o out --section 2/2 --set map.voxel_m=0.1 --quiet").code, 0);
  expect_refused("join out --quiet", "section 2 was planned with other options than section 1: \"voxel_m = 0.1\"");
  ASSERT_EQ(dvi("plan drive -o out --section 2/2 --quiet").code, 0);

  fs::copy(DVI_PROGRAM, folder / "another_build");
  std::ofstream(folder / "another_build", std::ios::app) << "x";
  const Result other = shell("./another_build join out --quiet");
  EXPECT_EQ(other.code, 3);
  EXPECT_THAT(other.err, HasSubstr("another build of dvi"));

  for (const char* section : {"1/3", "2/3", "3/3"})
    ASSERT_EQ(dvi("plan drive -o out --section " + std::string(section) + " --quiet").code, 0);
  expect_refused("join out --quiet", "has complete plans in 2 and in 3 sections");
  fs::remove_all(folder / "out/.dvi/sections/3");
  ASSERT_EQ(dvi("join out --quiet").code, 0);
  std::ofstream(folder / "drive/images/front/000002.png", std::ios::app) << "x";
  expect_refused("fill out --quiet", "the drive has changed since");
}

}  // namespace
}  // namespace dvi
