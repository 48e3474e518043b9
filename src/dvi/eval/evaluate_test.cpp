#include "dvi/eval/evaluate.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/threads.h"
#include "dvi/eval/evaluation.h"
#include "dvi/eval/metrics.h"
#include "dvi/eval/test_scene.h"
#include "dvi/io/write_image.h"

namespace dvi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const cv::Size kSize(96, 72);
const cv::Rect kHole(30, 20, 40, 30);

cv::Mat1b box(const cv::Rect& rect, uchar value = 255) {
  cv::Mat1b mask(kSize, uchar{0});
  mask(rect) = value;
  return mask;
}

/// A result folder and its truth, frame by frame; by default a perfect one.
class Evaluate : public testing::Test {
 protected:
  Evaluate() : folder(fs::path(testing::TempDir()) / ("evaluate_" + std::to_string(getpid()))) {
    for (const char* part : {"out/frames", "out/masks", "out/kind", "truth", "ignore"}) make_folder(folder / part);
  }
  ~Evaluate() override { fs::remove_all(folder); }

  void add(const std::string& name, const cv::Mat3b& truth, const cv::Mat3b& result, const cv::Mat1b& mask,
           const cv::Mat1b& kind) const {
    const std::string file = name + ".png";
    write_png(folder / "truth" / file, truth);
    write_png(folder / "out/frames" / file, result);
    write_png(folder / "out/masks" / file, mask);
    write_png(folder / "out/kind" / file, kind);
  }
  void add_perfect(const std::string& name) const { add(name, scene(kSize, 0), scene(kSize, 0), box(kHole), box(kHole, 1)); }
  Evaluation run(bool ignore = false) const {
    return evaluate(folder / "out", folder / "truth", ignore ? folder / "ignore" : fs::path());
  }
  std::string error() const {
    try {
      run();
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  fs::path folder;
};

TEST_F(Evaluate, APerfectResultIsPerfect) {
  add_perfect("000000");
  add_perfect("000001");
  const Evaluation e = run();
  const Figures& all = e.total[Origin::all];
  EXPECT_EQ(all.frames, 2U);
  EXPECT_EQ(all.pixels, 2U * 40 * 30);
  EXPECT_EQ(all.mae, 0);
  EXPECT_EQ(all.psnr, kMostPsnr);
  EXPECT_NEAR(all.ssim, 1, 1e-6);
  EXPECT_DOUBLE_EQ(all.sharpness, 1);
  EXPECT_LT(all.misplaced_px, 0.05);
  EXPECT_EQ(e.frames.size(), 2U);
  EXPECT_TRUE(e.unscored.empty());
  EXPECT_TRUE(e.warnings.empty());
}

TEST_F(Evaluate, CountsEveryKindForItself) {
  cv::Mat1b kind(kSize, uchar{0});
  for (int k = 1; k <= 5; ++k) kind(cv::Rect(30 + 8 * (k - 1), 20, 8, 30)) = static_cast<uchar>(k);
  const cv::Mat3b truth(kSize, cv::Vec3b(100, 100, 100));
  cv::Mat3b result = truth.clone();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c) result(y, x)[c] = static_cast<uchar>(100 + 2 * kind(y, x));
  add("a", truth, result, box(kHole), kind);
  const Evaluation e = run();
  EXPECT_DOUBLE_EQ(e.total[Origin::all].mae, 6);
  EXPECT_DOUBLE_EQ(e.total[Origin::copied].mae, 3);
  EXPECT_DOUBLE_EQ(e.total[Origin::copied].rmse, std::sqrt(10));
  EXPECT_DOUBLE_EQ(e.total[Origin::interpolated].mae, 6);
  EXPECT_DOUBLE_EQ(e.total[Origin::synthesised].mae, 8);
  EXPECT_DOUBLE_EQ(e.total[Origin::empty].mae, 10);
  EXPECT_DOUBLE_EQ(e.total[Origin::copied].share, 0.4);
  EXPECT_DOUBLE_EQ(e.total[Origin::empty].share, 0.2);
  EXPECT_NEAR(e.total[Origin::empty].psnr, 10 * std::log10(65025.0 / 100), 1e-9);
}

TEST_F(Evaluate, PoolsErrorsButAveragesPsnrOverFrames) {
  const cv::Mat3b truth(kSize, cv::Vec3b(100, 100, 100));
  add("a", truth, cv::Mat3b(kSize, cv::Vec3b(101, 101, 101)), box({10, 10, 10, 10}), box({10, 10, 10, 10}, 1));
  add("b", truth, cv::Mat3b(kSize, cv::Vec3b(110, 110, 110)), box({10, 10, 10, 30}), box({10, 10, 10, 30}, 3));
  const Evaluation e = run();
  EXPECT_DOUBLE_EQ(e.total[Origin::all].mae, (1 * 100 + 10 * 300) / 400.0);
  EXPECT_NEAR(e.total[Origin::all].psnr, (10 * std::log10(65025.0) + 10 * std::log10(650.25)) / 2, 1e-9);
  EXPECT_EQ(e.total[Origin::copied].frames, 1U);
  EXPECT_NEAR(e.total[Origin::copied].psnr, 10 * std::log10(65025.0), 1e-9);
}

TEST_F(Evaluate, LeavesOutIgnoredPixelsAndFramesWithoutAny) {
  cv::Mat3b wrong = scene(kSize, 0);
  wrong(cv::Rect(30, 20, 40, 10)) = cv::Vec3b(0, 0, 0);
  add("a", scene(kSize, 0), wrong, box(kHole), box(kHole, 1));
  add("b", scene(kSize, 0), wrong, box(kHole), box(kHole, 1));
  add("c", scene(kSize, 0), wrong, box({}), box({}));
  fs::remove(folder / "truth/c.png");
  write_png(folder / "ignore/a.png", box({30, 20, 40, 10}));
  write_png(folder / "ignore/b.png", box(kHole));
  EXPECT_GT(run().total[Origin::all].mae, 0);
  const Evaluation e = run(true);
  EXPECT_EQ(e.total[Origin::all].mae, 0);
  EXPECT_EQ(e.total[Origin::all].pixels, 40U * 20);
  EXPECT_THAT(e.unscored, ElementsAre("b", "c"));
  EXPECT_EQ(e.frames.size(), 1U);
  EXPECT_THAT(table(e), HasSubstr("b c"));
}

TEST_F(Evaluate, NeedsNoTruthFarFromTheMasks) {
  cv::Mat3b near(kSize, cv::Vec3b(0, 0, 0));
  const cv::Rect known(14, 4, 72, 62);
  for (int i = 0; i < 3; ++i) {
    const cv::Mat3b whole = scene(kSize, i);
    whole(known).copyTo(near(known));
    add(std::to_string(i), near, whole, box(kHole), box(kHole, 1));
  }
  const Evaluation e = run();
  EXPECT_EQ(e.total[Origin::all].mae, 0);
  EXPECT_NEAR(e.total[Origin::all].ssim, 1, 1e-6);
  EXPECT_DOUBLE_EQ(e.total[Origin::all].flicker, 1);
  EXPECT_LT(e.total[Origin::all].misplaced_px, 0.05);
}

TEST_F(Evaluate, SeesFlickerOfTheResult) {
  for (int i = 0; i < 4; ++i) {
    const cv::Mat3b truth = scene(kSize, 1.3 * i);
    cv::Mat3b result = truth.clone();
    result(kHole) += cv::Scalar::all(i % 2 ? 20 : 0);
    add(std::to_string(i), truth, result, box(kHole), box(kHole, 4));
  }
  const Evaluation e = run();
  EXPECT_GT(e.total[Origin::synthesised].flicker, 3);
  EXPECT_TRUE(std::isnan(e.frames[0].figures[Origin::all].flicker));
  EXPECT_GT(e.frames[1].figures[Origin::all].flicker, 3);
}

TEST_F(Evaluate, FlickerUnderAStillTruthIsUndefined) {
  for (int i = 0; i < 3; ++i) add(std::to_string(i), scene(kSize, 0), scene(kSize, 2), box(kHole), box(kHole, 1));
  EXPECT_TRUE(std::isnan(run().total[Origin::all].flicker));  // the truth has none to compare with
}

TEST_F(Evaluate, SeesShiftsAndBlur) {
  cv::Mat3b shifted = scene(kSize, 0);
  scene(kSize, 2)(kHole).copyTo(shifted(kHole));
  add("shifted", scene(kSize, 0), shifted, box(kHole), box(kHole, 2));
  EXPECT_NEAR(run().total[Origin::copied].misplaced_px, 2, 0.4);

  cv::Mat3b flat = scene(kSize, 0);
  flat(kHole) = cv::Vec3b(128, 128, 128);
  add("shifted", scene(kSize, 0), flat, box(kHole), box(kHole, 4));
  const Evaluation e = run();
  EXPECT_LT(e.total[Origin::all].sharpness, 0.2);
  EXPECT_TRUE(std::isnan(e.total[Origin::all].misplaced_px));
}

TEST_F(Evaluate, IsTheSameWithAnyNumberOfThreads) {
  for (int i = 0; i < 5; ++i) add(std::to_string(i), scene(kSize, i), scene(kSize, i + 0.4), box(kHole), box(kHole, 1));
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    const nlohmann::json json = run();
    return json.dump();
  };
  EXPECT_EQ(with(1), with(2));
  EXPECT_EQ(with(1), with(5));
}

TEST_F(Evaluate, TellsMachinesAndPeople) {
  add_perfect("a");
  write_png(folder / "truth/b.png", scene(kSize, 0));
  const Evaluation e = run();
  EXPECT_THAT(e.warnings, ElementsAre(HasSubstr("1 frames of the truth are not in the result: b")));
  const nlohmann::json json = nlohmann::json::parse(nlohmann::json(e).dump());
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["copied"]["pixels"], 1200);
  EXPECT_TRUE(json["empty"]["mae"].is_null());
  EXPECT_EQ(json["per_frame"][0]["name"], "a");
  EXPECT_THAT(table(e), HasSubstr("copied        100.0 %    0.00    0.00  100.00   1.000"));
}

TEST_F(Evaluate, CountsTicks) {
  add_perfect("a");
  add_perfect("b");
  int ticks = 0;
  evaluate(folder / "out", folder / "truth", {}, [&] { ++ticks; });
  EXPECT_EQ(ticks, 2);
}

TEST_F(Evaluate, SaysWhatIsWrongWithTheInput) {
  EXPECT_THAT(error(), HasSubstr("holds no frames"));
  add_perfect("a");
  write_png(folder / "ignore/zzz.png", box({}));
  EXPECT_THROW(run(true), InputError);

  write_png(folder / "truth/a.png", cv::Mat3b(10, 10, cv::Vec3b(0, 0, 0)));
  EXPECT_THAT(error(), HasSubstr("truth/a.png"));
  fs::rename(folder / "truth/a.png", folder / "truth/b.png");
  EXPECT_THAT(error(), HasSubstr("truth/a.png: is missing"));
  fs::remove(folder / "truth/b.png");
  EXPECT_THAT(error(), HasSubstr("truth: holds no PNG files"));

  add_perfect("a");
  write_png(folder / "out/kind/a.png", cv::Mat1b(10, 10, uchar{0}));
  EXPECT_THAT(error(), HasSubstr("kind/a.png"));
  fs::remove(folder / "out/kind/a.png");
  EXPECT_THAT(error(), HasSubstr("kind/a.png"));
  fs::remove_all(folder / "out/kind");
  EXPECT_THAT(error(), HasSubstr("holds no result (there is no kind/ in it)"));
}

}  // namespace
}  // namespace dvi
