#include "dvi/objects/detect/input.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

Description described(cv::Size input, Fit fit) {
  Description d;
  d.input = input;
  d.fit = fit;
  return d;
}

TEST(InputFit, LetterboxKeepsTheAspectRatioAndCentersTheImage) {
  const InputFit fit = fit_image({200, 100}, described({100, 80}, Fit::letterbox));
  EXPECT_EQ(fit.content, cv::Rect(0, 15, 100, 50));
  EXPECT_EQ(fit.to_image({50, 40}), cv::Point2d(100, 50)) << "the middle";
  EXPECT_EQ(fit.to_image({0, 15}), cv::Point2d(0, 0));
  const InputFit stretched = fit_image({200, 100}, described({100, 80}, Fit::stretch));
  EXPECT_EQ(stretched.content, cv::Rect(0, 0, 100, 80));
  EXPECT_EQ(stretched.to_image({100, 80}), cv::Point2d(200, 100));
}

TEST(InputBlob, HasScaledChannelsInTheirOrder) {
  Description d = described({2, 4}, Fit::letterbox);
  d.pad = 10;
  d.mean = {1, 2, 3};
  d.sigma = {1, 2, 4};
  const cv::Mat3b image(2, 2, cv::Vec3b(20, 40, 60));  // BGR
  const cv::Mat rgb = make_input_blob(image, fit_image(image.size(), d), d);
  ASSERT_EQ(rgb.dims, 4);
  const auto at = [](const cv::Mat& blob, int c, int y) { return blob.at<float>(cv::Vec4i(0, c, y, 1)); };
  EXPECT_EQ(at(rgb, 0, 1), 59);
  EXPECT_EQ(at(rgb, 1, 1), 19);
  EXPECT_EQ(at(rgb, 2, 2), 4.25F);
  EXPECT_EQ(at(rgb, 0, 0), 9) << "the ground of the letterbox";
  EXPECT_EQ(at(rgb, 1, 3), 4);
  d.channels = Channels::bgr;
  const cv::Mat bgr = make_input_blob(image, fit_image(image.size(), d), d);
  EXPECT_EQ(at(bgr, 0, 1), 19);
  EXPECT_EQ(at(bgr, 2, 1), 14.25F);
}

TEST(ResampleToImage, InterpolatesACoarseRampAtThePixels) {
  const Description d = described({64, 64}, Fit::letterbox);
  const InputFit fit = fit_image({128, 64}, d);  // content: 64 x 32 from row 16
  cv::Mat1f map(16, 16);                         // cells of 4 x 4: their centers' columns and rows in the input
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) map(y, x) = static_cast<float>(4 * x + 2 + 1000 * (4 * y + 2));
  const cv::Mat1f resampled = resample_to_image(map, fit, {40, 20, 10, 5});
  ASSERT_EQ(resampled.size(), cv::Size(10, 5));
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 10; ++x)
      EXPECT_NEAR(resampled(y, x), (40 + x + 0.5) / 2 + 1000 * ((20 + y + 0.5) / 2 + 16), 100) << x << " " << y;
}

}  // namespace
}  // namespace dvi::objects
