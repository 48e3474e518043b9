#include "dvi/harmonize/adapt_fill.h"

#include <cstdlib>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::harmonize {
namespace {

const cv::Size kImage(60, 40);

cv::Mat1b make_hole(const cv::Rect& rect) {
  cv::Mat1b hole(kImage, uchar{0});
  hole(rect) = 255;
  return hole;
}

/// A pattern with a period of 8 px around a gray level.
cv::Mat3b make_texture(int level) {
  cv::Mat3b image(kImage);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const int value = level + 5 * (x % 8) + 3 * (y % 5);
      image(y, x) = cv::Vec3b(static_cast<uchar>(value), static_cast<uchar>(value + 10), static_cast<uchar>(value + 20));
    }
  return image;
}

int find_largest_difference(const cv::Mat3b& a, const cv::Mat3b& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  double largest = 0;
  cv::minMaxLoc(difference.reshape(1), nullptr, &largest);
  return static_cast<int>(largest);
}

TEST(AdaptFill, RemovesAConstantOffsetOfTheFill) {
  const cv::Mat3b frame = make_texture(100), fill = make_texture(80);
  EXPECT_EQ(find_largest_difference(adapt_fill(frame, fill, make_hole({10, 10, 30, 20})), frame), 0);
}

TEST(AdaptFill, KeepsAFillThatAgreesWithTheBoundary) {
  const cv::Mat3b frame = make_texture(100);
  cv::Mat3b fill = frame.clone();
  fill(cv::Rect(20, 15, 5, 5)).setTo(cv::Scalar(10, 200, 90));
  EXPECT_EQ(find_largest_difference(adapt_fill(frame, fill, make_hole({10, 10, 30, 20})), fill), 0);
}

TEST(AdaptFill, FollowsAnOffsetThatVariesLinearly) {
  const cv::Mat3b frame = make_texture(100);
  cv::Mat3b fill = frame.clone();
  for (int y = 0; y < fill.rows; ++y)
    for (int x = 0; x < fill.cols; ++x) fill(y, x)[1] = static_cast<uchar>(fill(y, x)[1] + x);
  EXPECT_LE(find_largest_difference(adapt_fill(frame, fill, make_hole({10, 10, 30, 20})), frame), 1);
}

TEST(AdaptFill, IgnoresBoundaryPixelsThatShowAnotherObject) {
  const cv::Mat3b frame = make_texture(100);
  cv::Mat3b fill = make_texture(90);
  fill(cv::Rect(0, 14, 12, 6)).setTo(cv::Scalar(255, 255, 255));  // continues into the hole, but not in the frame
  const cv::Rect hole(10, 10, 30, 20), away(20, 10, 20, 20);
  const cv::Mat3b out = adapt_fill(frame, fill, make_hole(hole));
  EXPECT_LE(find_largest_difference(out(away), frame(away)), 1);
  EXPECT_GT(out(17, 10)[1], 230);
}

TEST(AdaptFill, KeepsPixelsOutsideTheHole) {
  const cv::Mat3b frame = make_texture(100), fill(kImage, cv::Vec3b(0, 0, 0));
  const cv::Mat1b hole = make_hole({0, 0, 60, 12});  // three sides are borders of the image
  cv::Mat3b out = adapt_fill(frame, fill, hole);
  out.setTo(0, hole);
  cv::Mat3b expected = frame.clone();
  expected.setTo(0, hole);
  EXPECT_EQ(find_largest_difference(out, expected), 0);
}

TEST(AdaptFill, TakesTheFillOfAWholeFrameAsItIs) {
  const cv::Mat3b fill = make_texture(60);
  EXPECT_EQ(find_largest_difference(adapt_fill(make_texture(100), fill, make_hole({0, 0, 60, 40})), fill), 0);
}

TEST(AdaptFill, ReturnsTheFrameIfThereIsNoHole) {
  const cv::Mat3b frame = make_texture(100);
  EXPECT_EQ(find_largest_difference(adapt_fill(frame, make_texture(20), make_hole({})), frame), 0);
}

}  // namespace
}  // namespace dvi::harmonize
