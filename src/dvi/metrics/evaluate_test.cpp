#include "dvi/metrics/evaluate.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/threads.h"
#include "dvi/media/write_image.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/metrics.h"
#include "dvi/metrics/test_result.h"
#include "dvi/metrics/test_scene.h"

namespace dvi::metrics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Evaluate : public ResultFixture {};

TEST_F(Evaluate, APerfectResultIsPerfect) {
  add_perfect("000000");
  add_perfect("000001");
  const Evaluation e = run();
  const Figures& all = e.total[Origin::all];
  EXPECT_EQ(all.frames, 2U);
  EXPECT_EQ(all.pixels, 2U * 40 * 30);
  EXPECT_EQ(all.mae, 0);
  EXPECT_EQ(all.psnr, kMaxPsnr);
  EXPECT_NEAR(all.ssim, 1, 1e-6);
  EXPECT_DOUBLE_EQ(all.sharpness, 1);
  EXPECT_LT(all.position_error_px, 0.05);
  EXPECT_EQ(e.frames.size(), 2U);
  EXPECT_TRUE(e.unscored.empty());
  EXPECT_TRUE(e.warnings.empty());
}

TEST_F(Evaluate, CountsEachKindSeparately) {
  cv::Mat1b kind(kSize, uchar{0});
  for (int k = 1; k <= 5; ++k) kind(cv::Rect(30 + 8 * (k - 1), 20, 8, 30)) = static_cast<uchar>(k);
  const cv::Mat3b truth(kSize, cv::Vec3b(100, 100, 100));
  cv::Mat3b result = truth.clone();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c) result(y, x)[c] = static_cast<uchar>(100 + 2 * kind(y, x));
  add("a", {truth, result, box(kHole), kind});
  const Evaluation e = run();
  EXPECT_DOUBLE_EQ(e.total[Origin::all].mae, 6);
  EXPECT_DOUBLE_EQ(e.total[Origin::copied].mae, 3);
  EXPECT_DOUBLE_EQ(e.total[Origin::copied].rmse, std::sqrt(10));
  EXPECT_DOUBLE_EQ(e.total[Origin::interpolated].mae, 6);
  EXPECT_DOUBLE_EQ(e.total[Origin::synthesized].mae, 8);
  EXPECT_DOUBLE_EQ(e.total[Origin::empty].mae, 10);
  EXPECT_DOUBLE_EQ(e.total[Origin::copied].share, 0.4);
  EXPECT_DOUBLE_EQ(e.total[Origin::empty].share, 0.2);
  EXPECT_NEAR(e.total[Origin::empty].psnr, 10 * std::log10(65025.0 / 100), 1e-9);
}

TEST_F(Evaluate, CountsPixelsOfAnotherProgramAsImported) {
  const cv::Mat3b truth(kSize, cv::Vec3b(100, 100, 100));
  add("a", {truth, cv::Mat3b(kSize, cv::Vec3b(104, 104, 104)), box(kHole), box(kHole, 6)});
  const Evaluation e = run();
  EXPECT_DOUBLE_EQ(e.total[Origin::imported].mae, 4);
  EXPECT_DOUBLE_EQ(e.total[Origin::imported].share, 1);
  EXPECT_TRUE(e.warnings.empty());
  EXPECT_NE(format_table(e).find("imported"), std::string::npos);
}

TEST_F(Evaluate, PoolsErrorsButAveragesPsnrOverFrames) {
  const cv::Mat3b truth(kSize, cv::Vec3b(100, 100, 100));
  add("a", {truth, cv::Mat3b(kSize, cv::Vec3b(101, 101, 101)), box({10, 10, 10, 10}), box({10, 10, 10, 10}, 1)});
  add("b", {truth, cv::Mat3b(kSize, cv::Vec3b(110, 110, 110)), box({10, 10, 10, 30}), box({10, 10, 10, 30}, 3)});
  const Evaluation e = run();
  EXPECT_DOUBLE_EQ(e.total[Origin::all].mae, (1 * 100 + 10 * 300) / 400.0);
  EXPECT_NEAR(e.total[Origin::all].psnr, (10 * std::log10(65025.0) + 10 * std::log10(650.25)) / 2, 1e-9);
  EXPECT_EQ(e.total[Origin::copied].frames, 1U);
  EXPECT_NEAR(e.total[Origin::copied].psnr, 10 * std::log10(65025.0), 1e-9);
}

TEST_F(Evaluate, ExcludesIgnoredPixelsAndFramesWithoutScoredPixels) {
  cv::Mat3b wrong = make_scene(kSize, 0);
  wrong(cv::Rect(30, 20, 40, 10)) = cv::Vec3b(0, 0, 0);
  add("a", {make_scene(kSize, 0), wrong, box(kHole), box(kHole, 1)});
  add("b", {make_scene(kSize, 0), wrong, box(kHole), box(kHole, 1)});
  add("c", {make_scene(kSize, 0), wrong, box({}), box({})});
  fs::remove(folder / "truth/c.png");
  media::write_png(folder / "ignore/a.png", box({30, 20, 40, 10}));
  media::write_png(folder / "ignore/b.png", box(kHole));
  EXPECT_GT(run().total[Origin::all].mae, 0);
  const Evaluation e = run(true);
  EXPECT_EQ(e.total[Origin::all].mae, 0);
  EXPECT_EQ(e.total[Origin::all].pixels, 40U * 20);
  EXPECT_THAT(e.unscored, ElementsAre("b", "c"));
  EXPECT_EQ(e.frames.size(), 1U);
  EXPECT_THAT(format_table(e), HasSubstr("b c"));
}

TEST_F(Evaluate, ScoresThePixelsOfTheGivenMasks) {
  // The run fills its hole perfectly, but its mask lacks the lower half of the object.
  cv::Mat3b result = make_scene(kSize, 0);
  result(cv::Rect(30, 50, 40, 10)) = cv::Vec3b(0, 0, 0);
  add("a", {make_scene(kSize, 0), result, box(kHole), box(kHole, 1)});
  make_folder(folder / "masks");
  EvaluationFolders given = folders();
  given.masks = folder / "masks";
  media::write_png(folder / "masks/a.png", box({30, 40, 40, 20}));
  const Evaluation all = evaluate(given);
  EXPECT_EQ(all.total[Origin::all].pixels, 40U * 20);
  EXPECT_GT(all.total[Origin::all].mae, 1);
  EXPECT_EQ(all.total[Origin::copied].pixels, 40U * 10);
  EXPECT_EQ(all.total[Origin::copied].mae, 0);
  EXPECT_THAT(all.warnings, ElementsAre(HasSubstr("400 scored pixels have kind 0")));

  media::write_png(folder / "ignore/a.png", box({30, 50, 40, 10}));
  given.ignore = folder / "ignore";
  EXPECT_EQ(evaluate(given).total[Origin::all].pixels, 40U * 10);
  EXPECT_EQ(evaluate(given).total[Origin::all].mae, 0);

  media::write_png(folder / "masks/a.png", box(kHole));
  given.ignore.clear();
  EXPECT_EQ(nlohmann::json(evaluate(given)).dump(), nlohmann::json(run()).dump()) << "the masks of the run";
}

TEST_F(Evaluate, ReportsFramesThatTheGivenMasksLack) {
  add_perfect("a");
  add_perfect("b");
  make_folder(folder / "masks");
  EvaluationFolders given = folders();
  given.masks = folder / "masks";
  EXPECT_THAT(error(given), HasSubstr("masks: has no NAME.png for any frame"));
  media::write_png(folder / "masks/b.png", box(kHole));
  EXPECT_THAT(error(given), HasSubstr("masks/a.png: is missing"));
  media::write_png(folder / "masks/a.png", cv::Mat1b(10, 10, uchar{0}));
  EXPECT_THAT(error(given), HasSubstr("masks/a.png: is 10x10 pixels instead of 96x72"));
}

TEST_F(Evaluate, DoesNotUseTheTruthFarFromTheMasks) {
  cv::Mat3b near(kSize, cv::Vec3b(0, 0, 0));
  const cv::Rect known(14, 4, 72, 62);
  for (int i = 0; i < 3; ++i) {
    const cv::Mat3b whole = make_scene(kSize, i);
    whole(known).copyTo(near(known));
    add(std::to_string(i), {near, whole, box(kHole), box(kHole, 1)});
  }
  const Evaluation e = run();
  EXPECT_EQ(e.total[Origin::all].mae, 0);
  EXPECT_NEAR(e.total[Origin::all].ssim, 1, 1e-6);
  EXPECT_DOUBLE_EQ(e.total[Origin::all].flicker, 1);
  EXPECT_LT(e.total[Origin::all].position_error_px, 0.05);
}

TEST_F(Evaluate, MeasuresFlicker) {
  for (int i = 0; i < 4; ++i) {
    const cv::Mat3b truth = make_scene(kSize, 1.3 * i);
    cv::Mat3b result = truth.clone();
    result(kHole) += cv::Scalar::all(i % 2 ? 20 : 0);
    add(std::to_string(i), {truth, result, box(kHole), box(kHole, 4)});
  }
  const Evaluation e = run();
  EXPECT_GT(e.total[Origin::synthesized].flicker, 3);
  EXPECT_TRUE(std::isnan(e.frames[0].figures[Origin::all].flicker));
  EXPECT_GT(e.frames[1].figures[Origin::all].flicker, 3);
}

TEST_F(Evaluate, FlickerIsUndefinedForAStaticTruth) {
  for (int i = 0; i < 3; ++i) add(std::to_string(i), {make_scene(kSize, 0), make_scene(kSize, 2), box(kHole), box(kHole, 1)});
  EXPECT_TRUE(std::isnan(run().total[Origin::all].flicker));  // the truth has none to compare with
}

TEST_F(Evaluate, MeasuresShiftsAndBlur) {
  cv::Mat3b shifted = make_scene(kSize, 0);
  make_scene(kSize, 2)(kHole).copyTo(shifted(kHole));
  add("shifted", {make_scene(kSize, 0), shifted, box(kHole), box(kHole, 2)});
  EXPECT_NEAR(run().total[Origin::copied].position_error_px, 2, 0.4);

  cv::Mat3b flat = make_scene(kSize, 0);
  flat(kHole) = cv::Vec3b(128, 128, 128);
  add("shifted", {make_scene(kSize, 0), flat, box(kHole), box(kHole, 4)});
  const Evaluation e = run();
  EXPECT_LT(e.total[Origin::all].sharpness, 0.2);
  EXPECT_TRUE(std::isnan(e.total[Origin::all].position_error_px));
}

TEST_F(Evaluate, DoesNotDependOnTheNumberOfThreads) {
  for (int i = 0; i < 5; ++i)
    add(std::to_string(i), {make_scene(kSize, i), make_scene(kSize, i + 0.4), box(kHole), box(kHole, 1)});
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    const nlohmann::json json = run();
    return json.dump();
  };
  EXPECT_EQ(with(1), with(2));
  EXPECT_EQ(with(1), with(5));
}

TEST_F(Evaluate, WritesJsonAndATable) {
  add_perfect("a");
  media::write_png(folder / "truth/b.png", make_scene(kSize, 0));
  const Evaluation e = run();
  EXPECT_THAT(e.warnings, ElementsAre(HasSubstr("1 frames of the truth are not in the result: b")));
  const nlohmann::json json = nlohmann::json::parse(nlohmann::json(e).dump());
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["copied"]["pixels"], 1200);
  EXPECT_TRUE(json["empty"]["mae"].is_null());
  EXPECT_EQ(json["per_frame"][0]["name"], "a");
  EXPECT_THAT(format_table(e), HasSubstr("copied        100.0 %    0.00    0.00  100.00   1.000"));
}

TEST_F(Evaluate, ReportsProgressPerFrame) {
  add_perfect("a");
  add_perfect("b");
  std::size_t frames = 0, ticks = 0;
  evaluate(folders(), [&](const char*, std::size_t count) {
    frames = count;
    return [&] { ++ticks; };
  });
  EXPECT_EQ(frames, 2U);
  EXPECT_EQ(ticks, 2U);
}

// The figures below are numpy's and scipy's:
//   y, x, c = np.mgrid[0:72, 0:96, 0:3]                       # channels 0, 1, 2 = B, G, R
//   a = (128 + 60 * ((x // 4 + y // 3) % 2) - 3 * (x % 7) + 20 * c) % 256
//   for k in (0, 7, 14): b = (a + (x * y) % (23 + k) - (x + 2 * y) % 11 + 5 * c) % 256 at [20:50, 30:70], a elsewhere
//   d = b - a of the three; mae, rmse = abs(d).mean(), sqrt((d ** 2).mean()); psnr, ssim: mean of the three frames'
//   SSIM as in metrics_test.cpp, with scipy.ndimage.gaussian_filter(gray, 1.5, truncate=3.5) as its window
TEST_F(Evaluate, AgreesWithNumpyInsideTheMaskAndOverWholeFrames) {
  for (const int k : {0, 7, 14}) {
    cv::Mat3b truth(kSize), result(kSize);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        for (int c = 0; c < 3; ++c) {
          const int value = (128 + 60 * ((x / 4 + y / 3) % 2) - 3 * (x % 7) + 20 * c) % 256;
          const int other = (value + (x * y) % (23 + k) - (x + 2 * y) % 11 + 5 * c) % 256;
          truth(y, x)[c] = static_cast<uchar>(value);
          result(y, x)[c] = static_cast<uchar>(kHole.contains({x, y}) ? other : value);
        }
    add(std::to_string(100 + k), {truth, result, box(kHole), box(kHole, 1)});
  }
  const Evaluation e = run();
  const Figures& all = e.total[Origin::all];
  EXPECT_NEAR(all.mae, 16.335, 1e-9);
  EXPECT_NEAR(all.rmse, 29.110511020108387, 1e-9);
  EXPECT_NEAR(all.psnr, 19.992394858779537, 1e-9);
  EXPECT_NEAR(all.ssim, 0.8970865941, 1e-6);
  EXPECT_NEAR(e.whole_frame.mae, 2.8359375, 1e-9);
  EXPECT_NEAR(e.whole_frame.rmse, 12.129379591711828, 1e-9);
  EXPECT_NEAR(e.whole_frame.psnr, 27.596619693011657, 1e-9);
  EXPECT_NEAR(e.whole_frame.ssim, 0.9805070538, 1e-6);
}

TEST_F(Evaluate, WholeFramesExcludeIgnoredPixels) {
  cv::Mat3b wrong = make_scene(kSize, 0);
  wrong(cv::Rect(30, 20, 40, 10)) = cv::Vec3b(0, 0, 0);
  add("a", {make_scene(kSize, 0), wrong, box(kHole), box(kHole, 1)});
  media::write_png(folder / "ignore/a.png", box({30, 20, 40, 10}));
  EXPECT_LT(run().whole_frame.ssim, 0.99);
  EXPECT_EQ(run(true).whole_frame.mae, 0);
  EXPECT_NEAR(run(true).whole_frame.ssim, 1, 1e-6);
}

TEST_F(Evaluate, OnlyFlickerDependsOnTheOrderOfFrames) {
  const std::vector<double> shifts = {0, 0.6, 1.7, 0.3};
  const auto add_in_order = [&](const std::vector<std::size_t>& order) {
    for (std::size_t i = 0; i < order.size(); ++i)
      add(std::to_string(i), {make_scene(kSize, 0), make_scene(kSize, shifts[order[i]]), box(kHole), box(kHole, 1)});
  };
  add_in_order({0, 1, 2, 3});
  const Evaluation one = run();
  add_in_order({2, 0, 3, 1});
  const Evaluation other = run();
  for (double Figures::* figure :
       {&Figures::mae, &Figures::rmse, &Figures::psnr, &Figures::ssim, &Figures::sharpness, &Figures::position_error_px}) {
    EXPECT_NEAR(one.total[Origin::all].*figure, other.total[Origin::all].*figure, 1e-12);
    EXPECT_FALSE(std::isnan(one.total[Origin::all].*figure));
  }
  EXPECT_NEAR(one.whole_frame.psnr, other.whole_frame.psnr, 1e-12);
}

TEST_F(Evaluate, HasIntervalsForTwoFramesOrMore) {
  add("a", {make_scene(kSize, 0), make_scene(kSize, 1), box(kHole), box(kHole, 1)});
  EXPECT_FALSE(run().intervals[0]);
  EXPECT_TRUE(nlohmann::json(run())["all"]["interval"].is_null());
  add("b", {make_scene(kSize, 0), make_scene(kSize, 2), box(kHole), box(kHole, 4)});
  const Evaluation e = run();
  const nlohmann::json json = e;
  EXPECT_TRUE(json["copied"]["interval"].is_null()) << "one frame only has copied pixels";
  EXPECT_LT(json["all"]["interval"]["psnr"][0], json["all"]["psnr"]);
  EXPECT_GT(json["all"]["interval"]["psnr"][1], json["all"]["psnr"]);
  EXPECT_FALSE(json["per_frame"][0]["all"].contains("interval"));
  EXPECT_THAT(format_table(e), testing::ContainsRegex("all .*[0-9]\\.\\.[0-9]"));
}

TEST_F(Evaluate, ComparesTheConfidenceWithTheError) {
  const cv::Mat3b truth(kSize, cv::Vec3b(100, 100, 100));
  cv::Mat3b result = truth.clone();
  result(cv::Rect(30, 20, 20, 30)) = cv::Vec3b(100, 111, 100);  // half of the hole
  add("a", {truth, result, box(kHole), box(kHole, 1)});
  EXPECT_TRUE(nlohmann::json(run())["confidence"].is_null());
  EXPECT_THAT(format_table(run()), testing::Not(HasSubstr("confidence")));

  make_folder(folder / "out/confidence");
  EXPECT_THAT(error(), HasSubstr("confidence/a.png"));
  cv::Mat1b confidence(kSize, uchar{255});
  confidence(cv::Rect(30, 20, 20, 30)) = 51;
  media::write_png(folder / "out/confidence/a.png", confidence);
  const nlohmann::json json = nlohmann::json(run())["confidence"];
  EXPECT_EQ(json["pixels"], 1200);
  EXPECT_DOUBLE_EQ(json["mean"], 0.6);
  EXPECT_DOUBLE_EQ(json["within"], 0.5);
  EXPECT_DOUBLE_EQ(json["ece"], 0.1);  // half at 0.2, all wrong; half at 1, all right
  EXPECT_NEAR(json["ause"], 0, 1e-12);
  ASSERT_EQ(json["deciles"].size(), 2);
  EXPECT_NEAR(json["deciles"][0]["mae"], 11.0 / 3, 1e-12);
  EXPECT_EQ(json["deciles"][1]["within"], 1);
  EXPECT_EQ(json["by_kind"]["copied"]["deciles"], json["deciles"]);
  EXPECT_TRUE(json["by_kind"]["empty"].is_null());
  EXPECT_THAT(format_table(run()), HasSubstr("confidence 0.600 on average, 0.500 of the pixels within 10 gray levels"));
}

TEST_F(Evaluate, WarnsThatNothingIsScored) {
  add("a", {make_scene(kSize, 0), make_scene(kSize, 0), box({}), box({})});
  add("b", {make_scene(kSize, 0), make_scene(kSize, 0), box({}), box({})});
  const Evaluation e = run();
  EXPECT_THAT(e.warnings, ElementsAre(HasSubstr("nothing is scored: every mask is empty")));
  EXPECT_THAT(format_table(e), HasSubstr("frames without scored pixels: a b"));
  EXPECT_TRUE(nlohmann::json::parse(nlohmann::json(e).dump())["whole_frame"]["psnr"].is_null());
}

TEST_F(Evaluate, ReportsErrorsInTheInput) {
  EXPECT_THAT(error(), HasSubstr("has no frames"));
  add_perfect("a");
  media::write_png(folder / "ignore/zzz.png", box({}));
  EXPECT_THROW(run(true), InputError);

  media::write_png(folder / "truth/a.png", cv::Mat3b(10, 10, cv::Vec3b(0, 0, 0)));
  EXPECT_THAT(error(), HasSubstr("truth/a.png"));
  add_perfect("a");
  media::write_png(folder / "out/masks/a.png", cv::Mat1b(10, 10, uchar{0}));
  EXPECT_THAT(error(), HasSubstr("masks/a.png: is 10x10 pixels instead of 96x72"));
  fs::remove(folder / "out/masks/a.png");
  EXPECT_THAT(error(), HasSubstr("masks/a.png"));
  add_perfect("a");
  fs::rename(folder / "truth/a.png", folder / "truth/b.png");
  EXPECT_THAT(error(), HasSubstr("truth/a.png: is missing"));
  fs::remove(folder / "truth/b.png");
  EXPECT_THAT(error(), HasSubstr("truth: has no PNG files"));

  add_perfect("a");
  media::write_png(folder / "out/kind/a.png", cv::Mat1b(10, 10, uchar{0}));
  EXPECT_THAT(error(), HasSubstr("kind/a.png"));
  fs::remove(folder / "out/kind/a.png");
  EXPECT_THAT(error(), HasSubstr("kind/a.png"));
  fs::remove_all(folder / "out/kind");
  EXPECT_THAT(error(), HasSubstr("has no result (kind/ is missing)"));
}

TEST_F(Evaluate, CountsOnlyArtifactsWithoutATruth) {
  add_perfect("000000");
  const Evaluation e = evaluate({folder / "out", {}});
  EXPECT_FALSE(e.has_truth);
  EXPECT_EQ(e.artifacts.hole, 40U * 30);
  EXPECT_TRUE(e.warnings.empty());
  EXPECT_FALSE(nlohmann::json(e).contains("all"));
  EXPECT_THROW(evaluate({folder / "out", {}, folder / "ignore"}), UsageError);
  EXPECT_THROW(evaluate({folder / "out", {}, {}, {}, folder / "masks"}), UsageError);
}

}  // namespace
}  // namespace dvi::metrics
