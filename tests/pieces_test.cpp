#include <gmock/gmock.h>

#include <fstream>

#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

/// Runs plan, fill, and finish.
class Pieces : public ProgramTest {
 protected:
  /// Returns the files of a result, without the files that only plans have.
  std::map<std::string, std::string> result(const std::string& out) const {
    std::map<std::string, std::string> files = contents(folder / out);
    std::erase_if(files,
                  [](const auto& file) { return file.first == ".dvi/plan.json" || file.first.starts_with(".dvi/costs"); });
    return files;
  }
  nlohmann::json json(const Result& result) const { return nlohmann::json::parse(result.out); }
  void expect_refused(const std::string& arguments, const std::string& reason) const {
    const Result refused = dvi(arguments);
    EXPECT_EQ(refused.code, 3) << arguments;
    EXPECT_THAT(refused.err, HasSubstr(reason));
    EXPECT_EQ(refused.out, "");
  }
};

TEST_F(Pieces, WriteTheSameBytesAsARun) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o whole --quiet").code, 0);
  const nlohmann::json plan = json(dvi("plan drive -o out --quiet --json"));
  EXPECT_EQ(plan["frames"], (nlohmann::json{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(plan["finished"], 0);
  // Ranges are out of order, they overlap, two run at once, and a part is repeated.
  const std::string fill = std::string(DVI_PROGRAM) + " fill out --quiet --frames ";
  const Result both = shell("{ " + fill + "3:5 & first=$!; " + fill + "2:4 --threads 1 && wait $first; }");
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_EQ(json(dvi("fill out --frames 4 --quiet --json"))["filled"], 0);
  expect_refused("finish out --quiet",
                 "lacks 2 of 6 frames: 0:1; dvi fill " + (folder / "out").string() + " --frames 0:1 fills");
  EXPECT_FALSE(fs::exists(folder / "out/report.json"));
  const nlohmann::json rest = json(dvi("fill out --quiet --json"));
  EXPECT_EQ(rest["filled"], 2);
  EXPECT_EQ(rest["frames"], 6);
  const Result finished = dvi("finish out --quiet --json");
  ASSERT_EQ(finished.code, 0) << finished.err;
  EXPECT_EQ(result("out"), result("whole"));
  EXPECT_GE(json(finished)["cost"]["frames_made"], 6) << "of all processes";
  EXPECT_EQ(json(dvi("finish out --quiet --json")), json(finished)) << "it is finished";
  EXPECT_THAT(dvi("run drive -o out").err, HasSubstr("nothing to do"));
}

TEST_F(Pieces, AreRefusedWithoutTheirPlan) {
  small_drive();
  expect_refused("fill nowhere", "does not contain a plan");
  expect_refused("finish drive", "does not contain a plan");
  ASSERT_EQ(dvi("plan drive -o out --quiet").code, 0);
  expect_refused("fill out --frames 6:9", "has no frames 6:9");
  EXPECT_EQ(dvi("fill out --frames x").code, 2);
  EXPECT_EQ(dvi("plan drive -o other --method telea").code, 2);
  EXPECT_FALSE(fs::exists(folder / "other"));

  fs::copy(DVI_PROGRAM, folder / "another_build");
  std::ofstream(folder / "another_build", std::ios::app) << "x";
  const Result other_build = shell("./another_build fill out --quiet");
  EXPECT_EQ(other_build.code, 3);
  EXPECT_THAT(other_build.err, HasSubstr("another build of dvi"));

  const fs::path options = folder / "out/dvi.toml", image = folder / "drive/images/front/000002.png";
  const auto with_changed = [&](const fs::path& file, const std::string& reason) {
    const std::string before = read_file(file);
    std::ofstream(file, std::ios::app) << (file == options ? "\n[video]\ncrf = 30\n" : "x");
    expect_refused("fill out --quiet", reason);
    expect_refused("finish out --quiet", reason);
    std::ofstream(file) << before;
  };
  with_changed(image, "the drive has changed since");
  fs::remove(folder / "out/.dvi/stages/map.bin");
  expect_refused("fill out --quiet", "map.bin: is missing or damaged");
}

TEST_F(Pieces, EncodeVideosInTheFill) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o whole --quiet").code, 0);
  ASSERT_EQ(dvi("plan drive -o out --quiet").code, 0);
  const fs::path segment = folder / "out/.dvi/video/000000.bin";
  ASSERT_EQ(dvi("fill out --frames 0:4 --quiet").code, 0);
  EXPECT_FALSE(fs::exists(segment)) << "its last frame is missing";
  const Result last = dvi("fill out --frames 5 --quiet");
  ASSERT_EQ(last.code, 0);
  EXPECT_EQ(last.err, "") << "of the encoder";
  ASSERT_TRUE(fs::exists(segment));
  std::ofstream(segment) << "cut";
  EXPECT_EQ(json(dvi("fill out --quiet --json"))["filled"], 0);
  EXPECT_GT(fs::file_size(segment), 1000U) << "a damaged segment is encoded again";
  std::ofstream(segment, std::ios::app) << "x";
  ASSERT_EQ(dvi("finish out --quiet").code, 0);
  EXPECT_EQ(result("out"), result("whole"));
}

TEST_F(Pieces, ContinueAfterAKilledFill) {
  small_drive();
  ASSERT_EQ(dvi("plan drive -o out --quiet").code, 0);
  ASSERT_EQ(dvi("fill out --frames 0:4 --quiet").code, 0);
  std::ofstream(folder / "out/.dvi/frames/000003.json") << "cut";
  std::ofstream(folder / "out/frames/.000004.part7.png") << "half";
  expect_refused("finish out --quiet", "lacks 2 of 6 frames: 3:3, 5:5");
  EXPECT_EQ(json(dvi("fill out --quiet --json"))["filled"], 2);
  ASSERT_EQ(dvi("finish out --quiet").code, 0);
  EXPECT_FALSE(fs::exists(folder / "out/frames/.000004.part7.png"));
}

}  // namespace
}  // namespace dvi
