#include "dvi/metrics/bootstrap.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/metrics/tally.h"

namespace dvi::metrics {
namespace {

OriginSums frame(double psnr, std::uint64_t absolute = 500) {
  OriginSums sums;
  sums.frames = 1;
  sums.pixels = 100;
  sums.error = {absolute, 10 * absolute, 300};
  sums.frame_psnr = psnr;
  sums.frame_ssim = psnr / 50;
  sums.gradient_result = {psnr, 100};
  sums.gradient_truth = {30, 100};
  return sums;
}

std::vector<OriginSums> frames(int count) {
  Random random(3);
  std::vector<OriginSums> out;
  for (int i = 0; i < count; ++i) out.push_back(frame(25 + 2 * random.normal(), static_cast<std::uint64_t>(random.below(900))));
  return out;
}

double width(const Interval& interval) { return interval[1] - interval[0]; }

TEST(Bootstrap, ContainsTheFigures) {
  const std::vector<OriginSums> some = frames(30);
  OriginSums sum;
  for (const OriginSums& frame : some) sum += frame;
  const Figures f = compute_figures(sum);
  const Intervals intervals = estimate_intervals(some).value();
  const auto expect_inside = [](double value, const Interval& interval) {
    EXPECT_LT(interval[0], value);
    EXPECT_GT(interval[1], value);
  };
  expect_inside(f.mae, intervals.mae);
  expect_inside(f.rmse, intervals.rmse);
  expect_inside(f.psnr, intervals.psnr);
  expect_inside(f.ssim, intervals.ssim);
  expect_inside(f.sharpness, intervals.sharpness);
}

TEST(Bootstrap, HasTheTheoreticalWidthForAMean) {
  for (const int count : {40, 400})
    EXPECT_NEAR(width(estimate_intervals(frames(count))->psnr), 2 * 1.96 * 2 / std::sqrt(count), 0.25 * 8 / std::sqrt(count));
}

TEST(Bootstrap, IsReproducible) {
  EXPECT_EQ(estimate_intervals(frames(10))->psnr, estimate_intervals(frames(10))->psnr);
  EXPECT_EQ(estimate_intervals(frames(10))->mae, estimate_intervals(frames(10))->mae);
}

TEST(Bootstrap, HasNoWidthForEqualFrames) {
  const Intervals intervals = estimate_intervals(std::vector<OriginSums>(12, frame(24))).value();
  EXPECT_EQ(intervals.mae[0], intervals.mae[1]);
  EXPECT_NEAR(intervals.psnr[0], 24, 1e-9);
  EXPECT_NEAR(width(intervals.psnr), 0, 1e-9);
}

TEST(Bootstrap, NeedsTwoFrames) {
  EXPECT_FALSE(estimate_intervals({}));
  EXPECT_FALSE(estimate_intervals({frame(24)}));
  const Intervals two = estimate_intervals({frame(20), frame(30)}).value();
  EXPECT_EQ(two.psnr, (Interval{20, 30}));
}

TEST(Bootstrap, IsUndefinedIfAResampleMayBe) {
  OriginSums flat = frame(24);
  flat.gradient_truth.sum = 0;
  EXPECT_TRUE(std::isnan(estimate_intervals({flat, frame(24)})->sharpness[0]));
}

}  // namespace
}  // namespace dvi::metrics
