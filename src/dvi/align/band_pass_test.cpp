#include "dvi/align/band_pass.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/random.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::align {
namespace {

constexpr int kWidth = 200, kHeight = 120;

cv::Mat1b make_empty_mask() { return cv::Mat1b(kHeight, kWidth, uchar{0}); }

/// Applies a gain to the brightness with the offset of the filter, so that it is exact in the filter.
cv::Mat3b expose(const cv::Mat3b& image, double gain) {
  cv::Mat3b out;
  image.convertTo(out, CV_8UC3, gain, 8 * gain - 8);
  return out;
}

double largest_difference(const cv::Mat1f& a, const cv::Mat1f& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(BandPass, RemovesAGainOfTheWholeFrame) {
  const cv::Mat3b image = waves(kWidth, kHeight, 1);
  const BandPass one = make_band_pass(image, make_empty_mask(), 3);
  ASSERT_EQ(one.size(), 3);
  EXPECT_GT(cv::norm(one[0], cv::NORM_INF), 0.1);
  for (const double gain : {0.6, 0.8, 1.15}) {
    const BandPass other = make_band_pass(expose(image, gain), make_empty_mask(), 3);
    for (std::size_t l = 0; l < 3; ++l) EXPECT_LT(largest_difference(one[l], other[l]), 0.01) << gain << " " << l;  // rounding
  }
}

TEST(BandPass, RemovesAGainThatChangesSlowly) {
  const cv::Mat3b image = waves(kWidth, kHeight, 2);
  cv::Mat3b lit = image.clone();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c) lit(y, x)[c] = cv::saturate_cast<uchar>((image(y, x)[c] + 8) * (0.7 + 0.3 * x / kWidth) - 8);
  const cv::Rect inside(16, 16, kWidth - 32, kHeight - 32);
  const cv::Mat1f before = make_band_pass(image, make_empty_mask(), 1)[0], after = make_band_pass(lit, make_empty_mask(), 1)[0];
  EXPECT_LT(cv::norm(before(inside), after(inside), cv::NORM_L1) / inside.area(), 0.005);
}

TEST(BandPass, IgnoresMaskedPixels) {
  cv::Mat3b image = waves(kWidth, kHeight, 3);
  cv::Mat1b mask = make_empty_mask();
  const cv::Rect hole(80, 40, 40, 30);
  mask(hole) = 255;
  const BandPass one = make_band_pass(image, mask, 2);
  image(hole) = cv::Vec3b(0, 0, 255);
  const BandPass other = make_band_pass(image, mask, 2);
  for (std::size_t l = 0; l < 2; ++l) EXPECT_EQ(largest_difference(one[l], other[l]), 0);
}

TEST(BandPass, LevelsHalveTheSize) {
  const BandPass levels = make_band_pass(waves(kWidth, kHeight + 1, 4), cv::Mat1b(kHeight + 1, kWidth, uchar{0}), 3);
  EXPECT_EQ(levels[1].size(), cv::Size(kWidth / 2, (kHeight + 2) / 2));
  EXPECT_EQ(levels[2].size(), cv::Size(kWidth / 4, 31));
}

TEST(Sample, HasTheValueAndSlopeOfAPlaneOnEveryLevel) {
  const cv::Size image(80, 60);
  for (const int scale : {1, 2, 4}) {
    cv::Mat1f level(image.height / scale, image.width / scale);
    for (int y = 0; y < level.rows; ++y)
      for (int x = 0; x < level.cols; ++x) {
        const double u = (x + 0.5) * scale - 0.5, v = (y + 0.5) * scale - 0.5;  // center of the pixel in the whole image
        level(y, x) = static_cast<float>(2 + 0.5 * u - 0.25 * v);
      }
    const ValueAndSlope found = sample(level, image, {33.3, 21.7});
    EXPECT_NEAR(found.value, 2 + 0.5 * 33.3 - 0.25 * 21.7, 1e-4) << scale;
    EXPECT_NEAR(found.slope.x(), 0.5, 1e-4) << scale;
    EXPECT_NEAR(found.slope.y(), -0.25, 1e-4) << scale;
  }
}

}  // namespace
}  // namespace dvi::align
