#include "dvi/image/blur.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"

namespace dvi {
namespace {

cv::Mat3f steps_and_noise(cv::Size size, std::uint64_t seed) {
  cv::Mat3f image(size);
  Random random(seed);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c)
        image(y, x)[c] = static_cast<float>(random.uniform(0, 55)) + ((x / 37 + y / 23 + c) % 2 == 0 ? 200.0F : 0.0F);
  return image;
}

TEST(Blurred, IsAGaussianOfAnyWidth) {
  for (const cv::Size size : {cv::Size(240, 130), cv::Size(97, 61), cv::Size(9, 5)}) {
    const cv::Mat3f image = steps_and_noise(size, 5);
    for (const double sigma_x : {1.0, 4.0, 5.0, 8.0, 10.0, 20.0})
      for (const double sigma_y : {sigma_x, 3.0}) {
        cv::Mat exact;
        cv::GaussianBlur(image, exact, {}, sigma_x, sigma_y, cv::BORDER_REFLECT);
        const cv::Mat fast = blurred(image, sigma_x, sigma_y);
        ASSERT_EQ(fast.size(), exact.size());
        EXPECT_LT(cv::norm(fast, exact, cv::NORM_INF), 0.01 * 255) << size << " " << sigma_x << " " << sigma_y;
      }
  }
}

TEST(Blurred, KeepsUniformImages) {
  const cv::Mat1f even(50, 70, 12.5F);
  for (const double sigma : {2.0, 9.0, 30.0}) EXPECT_LT(cv::norm(blurred(even, sigma), even, cv::NORM_INF), 1e-4);
}

}  // namespace
}  // namespace dvi
