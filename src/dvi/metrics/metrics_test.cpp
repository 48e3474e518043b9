#include "dvi/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/metrics/test_scene.h"

namespace dvi::metrics {
namespace {

TEST(ErrorSums, AgreeWithManualResults) {
  const cv::Mat3b truth(1, 3, cv::Vec3b(10, 10, 10));
  cv::Mat3b result = truth.clone();
  result(0, 0) = {13, 6, 10};   // 3, -4, 0
  result(0, 1) = {10, 10, 22};  // 0, 0, 12
  result(0, 2) = {255, 0, 255};
  cv::Mat1b pixels(1, 3, uchar{255});
  pixels(0, 2) = 0;
  const ErrorSums sums = sum_errors(result, truth, pixels);
  EXPECT_EQ(sums.values, 6U);
  EXPECT_DOUBLE_EQ(sums.mae(), 19.0 / 6);
  EXPECT_DOUBLE_EQ(sums.rmse(), std::sqrt(169.0 / 6));
  EXPECT_DOUBLE_EQ(sums.psnr(), 10 * std::log10(65025.0 * 6 / 169));
  EXPECT_DOUBLE_EQ(sum_errors(truth, truth, pixels).psnr(), kMaxPsnr);
  EXPECT_TRUE(std::isnan(ErrorSums{}.psnr()));
}

TEST(SumOver, IgnoresUndefinedValues) {
  const cv::Mat1f map = (cv::Mat1f(1, 4) << 1, 2, NAN, 8);
  const cv::Mat1b pixels = (cv::Mat1b(1, 4) << 255, 255, 255, 0);
  const PixelSum sum = sum_over(map, pixels);
  EXPECT_EQ(sum.count, 2U);
  EXPECT_DOUBLE_EQ(sum.mean(), 1.5);
}

// The figures below are scikit-image's (0.19.3):
//   y, x, c = np.mgrid[0:48, 0:64, 0:3]                       # channels 0, 1, 2 = B, G, R
//   a = (128 + 60 * ((x // 4 + y // 3) % 2) - 3 * (x % 7) + 20 * c) % 256
//   b = (a + (x * y) % 23 - (x + 2 * y) % 11 + 5 * c) % 256
//   gray = lambda i: 0.114 * i[..., 0] + 0.587 * i[..., 1] + 0.299 * i[..., 2]
//   mean, full = skimage.metrics.structural_similarity(gray(a), gray(b), gaussian_weights=True, sigma=1.5,
//                                                      use_sample_covariance=False, data_range=255, full=True)
TEST(Ssim, AgreesWithScikitImage) {
  cv::Mat3b a(48, 64), b(48, 64);
  for (int y = 0; y < a.rows; ++y)
    for (int x = 0; x < a.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        const int value = (128 + 60 * ((x / 4 + y / 3) % 2) - 3 * (x % 7) + 20 * c) % 256;
        a(y, x)[c] = static_cast<uchar>(value);
        b(y, x)[c] = static_cast<uchar>((value + (x * y) % 23 - (x + 2 * y) % 11 + 5 * c) % 256);
      }
  const cv::Mat1f map = compute_ssim(a, b);
  EXPECT_NEAR(map(0, 0), 0.994922, 1e-6);
  EXPECT_NEAR(map(0, 30), 0.958791, 1e-6);
  EXPECT_NEAR(map(24, 32), 0.973530, 1e-6);
  EXPECT_NEAR(map(47, 63), 0.896278, 1e-6);
  EXPECT_NEAR(map(17, 5), 0.967263, 1e-6);
  EXPECT_NEAR(cv::mean(map)[0], 0.956734, 1e-6);
  EXPECT_NEAR(cv::mean(map(cv::Rect(20, 10, 30, 20)))[0], 0.954255, 1e-6);
}

TEST(Gradient, IsTheSlopeOfARamp) {
  cv::Mat3b ramp(8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) ramp(y, x) = cv::Vec3b::all(static_cast<uchar>(3 * x + 4 * y));
  EXPECT_NEAR(compute_gradient(ramp)(4, 4), 5, 1e-4);
}

TEST(Change, FollowsTheMotion) {
  const cv::Size size(80, 60);
  const cv::Mat3b before = make_scene(size, 0), now = make_scene(size, 3);  // content moves 3 px to the right
  const cv::Mat2f back(size, cv::Vec2f(-3, 0));
  const cv::Mat1b all(size, uchar{255});
  const cv::Mat1f change = compute_change(now, before, back, all);
  const PixelSum sum = sum_over(change, all);
  EXPECT_EQ(sum.count, static_cast<std::size_t>((80 - 3) * 60));  // the other pixels come from outside the image
  EXPECT_DOUBLE_EQ(sum.sum, 0);
  EXPECT_GT(sum_over(compute_change(now, before, cv::Mat2f(size, cv::Vec2f(0, 0)), all), all).mean(), 5);
  EXPECT_TRUE(std::isnan(compute_change(now, before, back, cv::Mat1b(size, uchar{0}))(30, 40)));
}

TEST(PositionError, IsTheShiftOfTheContent) {
  const cv::Size size(160, 120);
  cv::Mat1b pixels(size, uchar{0});
  pixels(cv::Rect(40, 30, 80, 60)) = 255;
  for (const double shift : {0.0, 1.0, 2.5}) {
    const cv::Mat1f map = compute_position_error(make_scene(size, shift), make_scene(size, 0), pixels);
    std::vector<float> lengths;
    for (int y = 40; y < 80; ++y) lengths.insert(lengths.end(), &map(y, 50), &map(y, 110));
    std::nth_element(lengths.begin(), lengths.begin() + 1200, lengths.end());
    EXPECT_NEAR(lengths[1200], shift, 0.2);
  }
}

}  // namespace
}  // namespace dvi::metrics
