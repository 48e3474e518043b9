#include <gmock/gmock.h>

#include <array>

#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class Holdout : public ProgramTest {
 protected:
  void expect_refused(const std::string& arguments, const std::string& word) const {
    const Result result = dvi(arguments);
    EXPECT_EQ(result.code, 3) << result.err;
    EXPECT_THAT(result.err, HasSubstr(word));
  }
};

TEST_F(Holdout, ACaseIsFilledAndScored) {
  small_drive();
  const Result made = dvi("holdout drive -o case --scenario lead --quiet --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const nlohmann::json j = nlohmann::json::parse(made.out);
  EXPECT_EQ(j["scenario"], "lead");
  EXPECT_EQ(j["frames"].size(), 6);
  EXPECT_GT(j["frames"][0]["scored_pixels"], 50);
  ASSERT_EQ(dvi("run case/drive -o out --quiet").code, 0);
  const Result scored = dvi("eval out --truth case/truth --ignore case/ignore --quiet --json");
  ASSERT_EQ(scored.code, 0) << scored.err;
  EXPECT_GT(nlohmann::json::parse(scored.out)["all"]["pixels"], 300);
}

TEST_F(Holdout, PixelsThatIncompleteMasksLackAreScored) {
  small_drive();
  const Result made = dvi("holdout drive -o case --scenario lead --mask-errors burst --quiet --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const nlohmann::json j = nlohmann::json::parse(made.out);
  EXPECT_EQ(j["mask_errors"], "burst");
  EXPECT_FALSE(j["vehicle"].contains("track"));
  int missed = 0, scored = 0;
  for (const nlohmann::json& frame : j["frames"]) {
    missed += frame["masked_pixels"] == 0 ? 1 : 0;
    scored += frame["scored_pixels"].get<int>();
  }
  EXPECT_EQ(missed, 5);
  ASSERT_EQ(dvi("run case/drive -o out --set objects.complete=false --quiet").code, 0);
  const std::string call = "eval out --truth case/truth --ignore case/ignore --quiet --json";
  const nlohmann::json given = nlohmann::json::parse(dvi(call).out)["all"];
  const Result all = dvi(call + " --masks case/truth_masks");
  ASSERT_EQ(all.code, 0) << all.err;
  const nlohmann::json complete = nlohmann::json::parse(all.out)["all"];
  EXPECT_EQ(complete["pixels"], scored);
  EXPECT_LT(given["pixels"], scored);
  EXPECT_GT(complete["mae"], given["mae"]);
  fs::remove(folder / "case/truth_masks/000003.png");
  expect_refused(call + " --masks case/truth_masks", "truth_masks/000003.png: is missing");
}

TEST_F(Holdout, SelfcheckMakesEachPartOnce) {
  small_drive();
  const std::string call = "selfcheck drive -o check --scenario parked --scenario banner --quiet";
  const Result first = dvi(call);
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_THAT(first.out, testing::AllOf(HasSubstr("parked"), HasSubstr("banner"), HasSubstr("PSNR")));
  const fs::path made = folder / "check/parked/case/holdout.json", filled = folder / "check/parked/result/frames/000002.png";
  const auto case_time = fs::last_write_time(made), frame_time = fs::last_write_time(filled);
  const Result second = dvi(call + " --json");
  ASSERT_EQ(second.code, 0) << second.err;
  EXPECT_EQ(fs::last_write_time(made), case_time);
  EXPECT_EQ(fs::last_write_time(filled), frame_time);
  const nlohmann::json j = nlohmann::json::parse(second.out);
  EXPECT_EQ(j, nlohmann::json::parse(read_file(folder / "check/selfcheck.json")));
  EXPECT_EQ(j["scenarios"][0]["scenario"], "parked");
  EXPECT_GT(j["scenarios"][1]["evaluation"]["all"]["pixels"], 100);

  make_folder(folder / "net");
  fs::copy(folder / "check/banner/case/truth", folder / "net/banner", fs::copy_options::recursive);
  const std::string with_net = "selfcheck drive -o check --scenario banner --external net=net --quiet";
  const nlohmann::json held = nlohmann::json::parse(dvi(with_net + " --json").out)["scenarios"][0]["evaluation"];
  EXPECT_EQ(held["external"]["net"]["all"]["mae"], 0);
  EXPECT_GT(held["all"]["mae"], 0);
  EXPECT_THAT(dvi(with_net).out, HasSubstr("\n  net "));
  expect_refused("selfcheck drive -o check --scenario parked --external net=net --quiet", "net/parked: is not a folder");
  expect_refused("selfcheck drive -o check --scenario parked --seed 2 --quiet", "another drive or with other options");
}

TEST_F(Holdout, WarnsIfNoPlaceIsFree) {
  const fs::path drive = small_drive();
  EXPECT_THAT(dvi("holdout drive -o free --scenario parked").err, testing::Not(HasSubstr("warning")));
  for (const auto& entry : fs::directory_iterator(drive / "lidar")) {  // a wall to the right
    std::string returns = read_file(entry.path());
    for (float x = -30; x < 60; x += 0.5F) {
      const std::array<float, 4> point{x, -3.1F, -0.8F, 0.5F};
      returns.append(reinterpret_cast<const char*>(point.data()), sizeof point);
    }
    write_file(entry.path(), returns);
  }
  const Result walled = dvi("holdout drive -o case --scenario parked --json");
  ASSERT_EQ(walled.code, 0) << walled.err;
  EXPECT_THAT(walled.err, testing::AllOf(HasSubstr("no place within 15 m along the road is free"), HasSubstr("--seed")));
  EXPECT_GT(nlohmann::json::parse(walled.out)["vehicle"]["stand"]["returns"], 0);
}

TEST_F(Holdout, RefusesUnknownScenariosAndUsedFolders) {
  const fs::path drive = small_drive();
  EXPECT_EQ(dvi("holdout drive -o case --scenario meteor").code, 2);
  EXPECT_EQ(dvi("selfcheck drive --scenario meteor").code, 2);
  const Result unknown = dvi("holdout drive -o case --mask-errors blurred");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("none, miss, burst, late, tight, boxes, false"));
  EXPECT_EQ(dvi("holdout drive").code, 2);
  EXPECT_FALSE(fs::exists(folder / "case"));
  make_folder(folder / "mine");
  write_file(folder / "mine/thesis.tex", "years of work");
  expect_refused("holdout drive -o mine --quiet", "not an empty folder");
  fs::remove(drive / "poses.txt");
  fs::remove_all(drive / "lidar");
  expect_refused("holdout drive -o case --quiet", "poses");
  EXPECT_FALSE(fs::exists(folder / "case"));
}

}  // namespace
}  // namespace dvi
