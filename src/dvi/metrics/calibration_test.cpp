#include "dvi/metrics/calibration.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::metrics {
namespace {

struct Pixel {
  std::uint8_t confidence;
  cv::Vec3b difference;  // difference from a black truth
  double mae() const { return (difference[0] + difference[1] + difference[2]) / 3.0; }
  bool within() const { return std::max({difference[0], difference[1], difference[2]}) <= 10; }
};

ConfidenceCounts counts(const std::vector<Pixel>& pixels) {
  ConfidenceCounts out;
  for (const Pixel& pixel : pixels) out.add(pixel.confidence, pixel.difference, {});
  return out;
}

std::vector<Pixel> make_random_pixels(int count) {
  Random random(7);
  std::vector<Pixel> pixels;
  for (int i = 0; i < count; ++i) {
    const int confidence = random.below(60) * 255 / 59;
    Pixel pixel{static_cast<std::uint8_t>(confidence), {}};
    for (int c = 0; c < 3; ++c) pixel.difference[c] = static_cast<std::uint8_t>(random.below(1 + (300 - confidence) / 4));
    pixels.push_back(pixel);
  }
  return pixels;
}

/// Computes the mean error of the remaining pixels, averaged over the removed share by a fine sum. `pixels` (key, error) are
/// removed by increasing key; pixels with the same key have their mean error.
double compute_sparsification_area(std::vector<std::pair<double, double>> pixels) {
  std::sort(pixels.begin(), pixels.end());
  double total = 0;
  for (auto first = pixels.begin(); first != pixels.end();) {
    const auto last = std::find_if(first, pixels.end(), [&](const auto& pixel) { return pixel.first != first->first; });
    double sum = 0;
    for (auto it = first; it != last; ++it) sum += it->second;
    total += sum;
    for (auto it = first; it != last; ++it) it->second = sum / static_cast<double>(last - first);
    first = last;
  }
  constexpr int kSteps = 200;
  double area = 0, left = total, count = static_cast<double>(pixels.size());
  for (const auto& [key, error] : pixels)
    for (int step = 0; step < kSteps; ++step) {
      left -= error / (2 * kSteps), count -= 0.5 / kSteps;
      area += left / count;
      left -= error / (2 * kSteps), count -= 0.5 / kSteps;
    }
  return area / kSteps / total;
}

TEST(Calibration, AgreesWithManualResults) {
  const Calibration c =
      counts({{255, {10, 10, 10}}, {255, {11, 0, 0}}, {51, {0, 0, 0}}, {0, {0, 0, 13}}}).compute_calibration().value();
  EXPECT_EQ(c.pixels, 4U);
  EXPECT_DOUBLE_EQ(c.mean, (1 + 1 + 0.2 + 0) / 4);
  EXPECT_DOUBLE_EQ(c.within, 0.5);
  EXPECT_DOUBLE_EQ(c.ece, (2 * 0.5 + 0.8 + 0) / 4);
  ASSERT_EQ(c.deciles.size(), 3U);
  EXPECT_DOUBLE_EQ(c.deciles[2].confidence, 1);
  EXPECT_DOUBLE_EQ(c.deciles[2].mae, 41.0 / 6);
  EXPECT_FALSE(ConfidenceCounts{}.compute_calibration());
}

TEST(Calibration, RanksTheErrorsOfTwoPixels) {
  // Right order: with r pixels in (1, 2] left, (r - 1) / r of the error remains, then none. Wrong order: 1 / r, then all.
  const auto ause = [](std::uint8_t good, std::uint8_t bad) {
    return counts({{good, {0, 0, 0}}, {bad, {30, 30, 30}}}).compute_calibration()->ause;
  };
  EXPECT_NEAR(ause(200, 100), 0, 1e-12);
  EXPECT_NEAR(ause(100, 100), std::log(2), 1e-12);
  EXPECT_NEAR(ause(100, 200), 2 * std::log(2), 1e-12);
  EXPECT_TRUE(std::isnan(counts({{9, {0, 0, 0}}}).compute_calibration()->ause));
}

TEST(Calibration, AgreesWithBruteForce) {
  const std::vector<Pixel> pixels = make_random_pixels(3000);
  const Calibration c = counts(pixels).compute_calibration().value();
  std::vector<double> confidence(10), within(10), number(10);
  std::vector<std::pair<double, double>> by_confidence, by_error;
  for (const Pixel& pixel : pixels) {
    const auto bin = static_cast<std::size_t>(std::min(9.0, std::floor(pixel.confidence / 25.5)));
    confidence[bin] += pixel.confidence / 255.0;
    within[bin] += pixel.within() ? 1 : 0;
    ++number[bin];
    by_confidence.emplace_back(pixel.confidence, pixel.mae());
    by_error.emplace_back(-pixel.mae(), pixel.mae());
  }
  double ece = 0;
  for (std::size_t bin = 0; bin < 10; ++bin) ece += std::abs(confidence[bin] - within[bin]) / 3000;
  EXPECT_NEAR(c.ece, ece, 1e-12);
  EXPECT_NEAR(c.ause, compute_sparsification_area(by_confidence) - compute_sparsification_area(by_error), 1e-5);
  EXPECT_GT(c.ause, 0);
}

TEST(Calibration, DecilesHaveATenthEachByIncreasingConfidence) {
  std::vector<Pixel> pixels;
  for (int i = 0; i < 200; ++i) pixels.push_back({static_cast<std::uint8_t>(i), {static_cast<uchar>(200 - i), 0, 0}});
  const Calibration c = counts(pixels).compute_calibration().value();
  ASSERT_EQ(c.deciles.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(c.deciles[i].pixels, 20U);
    EXPECT_NEAR(c.deciles[i].confidence, (20 * static_cast<double>(i) + 9.5) / 255, 1e-12);
    EXPECT_NEAR(c.deciles[i].mae, (190.5 - 20 * static_cast<double>(i)) / 3, 1e-12);
  }
  EXPECT_EQ(counts(std::vector<Pixel>(50, Pixel{80, {}})).compute_calibration()->deciles.size(), 1U);
}

TEST(Calibration, IsTheSameFromPartialCounts) {
  const std::vector<Pixel> pixels = make_random_pixels(1000);
  ConfidenceCounts sum = counts({pixels.begin() + 300, pixels.end()});
  sum += counts({pixels.begin(), pixels.begin() + 300});
  const Calibration parts = sum.compute_calibration().value(), whole = counts(pixels).compute_calibration().value();
  EXPECT_EQ(parts.ece, whole.ece);
  EXPECT_EQ(parts.ause, whole.ause);
  EXPECT_EQ(parts.deciles.size(), whole.deciles.size());
}

}  // namespace
}  // namespace dvi::metrics
