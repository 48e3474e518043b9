#include "dvi/image/nearest_pixel.h"

#include <gtest/gtest.h>

namespace dvi {
namespace {

TEST(NearestPixel, IsFoundWithinADistance) {
  cv::Mat1b mask(20, 30, uchar{0});
  mask(5, 5) = mask(5, 25) = 255;
  const NearestPixel nearest(mask);
  EXPECT_EQ(nearest.find({7, 5}), cv::Point(5, 5));
  EXPECT_EQ(nearest.find({20, 9}), cv::Point(25, 5));
  EXPECT_EQ(nearest.find({25, 5}, 0), cv::Point(25, 5));
  EXPECT_EQ(nearest.find({22, 5}, 3.5F), cv::Point(25, 5));
  EXPECT_EQ(nearest.find({20, 5}, 3.5F), std::nullopt);
}

TEST(NearestPixel, IsMissingInAnEmptyMask) {
  const NearestPixel nearest(cv::Mat1b(20, 30, uchar{0}));
  EXPECT_EQ(nearest.find({7, 5}), std::nullopt);
  EXPECT_EQ(nearest.find({7, 5}, 100), std::nullopt);
}

}  // namespace
}  // namespace dvi
