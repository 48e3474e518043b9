#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"

namespace dvi {
namespace {

cv::Mat1b mask_of(const std::vector<std::string>& rows) {
  cv::Mat1b mask(static_cast<int>(rows.size()), static_cast<int>(rows[0].size()));
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) mask(y, x) = rows[y][x] == '#' ? 255 : 0;
  return mask;
}

bool equal(const cv::Mat1b& a, const cv::Mat1b& b) { return a.size() == b.size() && cv::countNonZero(a != b) == 0; }

cv::Mat3b noise(int width, int height, std::uint64_t seed) {
  cv::Mat3b image(height, width);
  Random random(seed);
  for (cv::Vec3b& pixel : image)
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uchar>(random.below(256));
  return image;
}

TEST(Quantized, IsTheNearestSixteenth) {
  EXPECT_EQ(quantize(3.0, 7.5), cv::Point2f(3.0F, 7.5F));
  EXPECT_EQ(quantize(0.031, 0.032), cv::Point2f(0, 1 / 16.0F));
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(0, 4000), y = random.uniform(0, 3000);
    const cv::Point2f q = quantize(x, y);
    ASSERT_LE(std::abs(q.x - x), 1 / 32.0);
    ASSERT_LE(std::abs(q.y - y), 1 / 32.0);
    // The value is read back unchanged from a 16-bit file.
    const auto written = static_cast<std::uint16_t>(q.x * kSubpixel);
    ASSERT_EQ(static_cast<float>(written) / kSubpixel, q.x);
  }
}

TEST(Bilinear, EqualsPixelsAtWholePositions) {
  const cv::Mat3b image = noise(7, 5, 1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      ASSERT_EQ(bilinear(image, cv::Point2f(static_cast<float>(x), static_cast<float>(y))), cv::Vec3f(image(y, x)));
}

TEST(Bilinear, ReproducesRampsExactly) {
  cv::Mat3b image(10, 12);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      image(y, x) = cv::Vec3b(static_cast<uchar>(16 * x), static_cast<uchar>(16 * y), static_cast<uchar>(3 * x + 5 * y));
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const cv::Point2f at = quantize(random.uniform(0, 11), random.uniform(0, 9));
    ASSERT_EQ(bilinear(image, at), cv::Vec3f(16 * at.x, 16 * at.y, 3 * at.x + 5 * at.y)) << at;
  }
}

TEST(Bilinear, StaysBetweenItsNeighborsUpToTheEdge) {
  const cv::Mat3b image = noise(6, 4, 3);
  double low = 0, high = 0;
  cv::minMaxLoc(image.reshape(1), &low, &high);
  for (float y = 0; y <= 3; y += 1 / kSubpixel)
    for (float x = 0; x <= 5; x += 1 / kSubpixel)
      for (int c = 0; c < 3; ++c) {
        const float value = bilinear(image, {x, y})[c];
        ASSERT_GE(value, low);
        ASSERT_LE(value, high);
      }
}

TEST(Bilinear, SupportsImagesOfOneRowOrColumn) {
  const cv::Mat3b pixel(1, 1, cv::Vec3b(1, 2, 3));
  EXPECT_EQ(bilinear(pixel, {0, 0}), cv::Vec3f(1, 2, 3));
  const cv::Mat3b row = (cv::Mat3b(1, 2) << cv::Vec3b(0, 0, 0), cv::Vec3b(100, 50, 10));
  EXPECT_EQ(bilinear(row, {0.5F, 0}), cv::Vec3f(50, 25, 5));
}

TEST(Region, NumbersItsPixelsInRasterOrder) {
  const Region region(mask_of({".#.", "#.#", "..."}));
  ASSERT_EQ(region.size(), 3U);
  EXPECT_EQ(region.pixels, (std::vector<cv::Point>{{1, 0}, {0, 1}, {2, 1}}));
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) {
      const int i = region.index(y, x);
      if (i >= 0) {
        EXPECT_EQ(region.pixels[i], cv::Point(x, y));
      }
    }
  EXPECT_EQ(cv::countNonZero(region.index >= 0), 3);
}

TEST(Region, IsEmptyForAnEmptyMask) {
  EXPECT_EQ(Region().size(), 0U);
  EXPECT_EQ(Region(mask_of({"...", "..."})).size(), 0U);
  EXPECT_EQ(Region(cv::Mat1b()).size(), 0U);
}

TEST(Grown, EnlargesAndShrinksByItsRadius) {
  const cv::Mat1b dot = mask_of({".....", ".....", "..#..", ".....", "....."});
  EXPECT_TRUE(equal(grown(dot, 0), dot));
  EXPECT_TRUE(equal(grown(dot, 1), mask_of({".....", "..#..", ".###.", "..#..", "....."})));
  EXPECT_TRUE(equal(grown(grown(dot, 1), -1), dot));
  EXPECT_EQ(cv::countNonZero(grown(dot, -1)), 0);
  EXPECT_EQ(cv::countNonZero(dot), 1) << "the input is unchanged";
}

TEST(Grown, IgnoresTheBorderOfTheImage) {
  const cv::Mat1b full(6, 8, uchar{255});
  EXPECT_TRUE(equal(grown(full, -2), full));
}

TEST(Grown, IsThatOfTheWholeImage) {
  for (const cv::Rect& hole : {cv::Rect(30, 20, 9, 14), cv::Rect(0, 0, 5, 30), cv::Rect(85, 60, 15, 10), cv::Rect()}) {
    cv::Mat1b mask(70, 100, uchar{0});
    for (int y = hole.y; y < hole.br().y; ++y)
      for (int x = hole.x; x < hole.br().x; ++x) mask(y, x) = (x * 7 + y * 5) % 3 == 0 ? 0 : 255;
    for (const int radius : {1, 3, 11}) {
      const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
      cv::Mat1b larger, smaller;
      cv::dilate(mask, larger, disc);
      cv::erode(mask, smaller, disc);
      EXPECT_TRUE(equal(grown(mask, radius), larger));
      EXPECT_TRUE(equal(grown(mask, -radius), smaller));
      cv::Mat1f outside, inside;
      cv::distanceTransform(cv::Mat1b(mask == 0), outside, cv::DIST_L2, cv::DIST_MASK_5);
      cv::distanceTransform(mask, inside, cv::DIST_L2, cv::DIST_MASK_5);
      EXPECT_TRUE(equal(grown_far(mask, radius), cv::Mat1b(outside <= radius)));
      EXPECT_TRUE(equal(grown_far(mask, -radius), cv::Mat1b(inside > radius)));
    }
  }
}

TEST(PartBoxes, AreInTheOrderOfTheWholeImage) {
  cv::Mat1b mask(90, 130, uchar{0});
  for (const cv::Rect& part : {cv::Rect(41, 31, 3, 2), cv::Rect(50, 30, 4, 9), cv::Rect(33, 33, 2, 2), cv::Rect(60, 40, 1, 1)})
    mask(part) = 255;
  cv::Mat1i labels, boxes;
  cv::Mat1d centers;
  const int count = cv::connectedComponentsWithStats(mask, labels, boxes, centers, 8, CV_32S);
  std::vector<cv::Rect> expected;
  for (int i = 1; i < count; ++i) expected.push_back(box_of_part(boxes, i));
  EXPECT_EQ(find_part_boxes(mask), expected);
  EXPECT_EQ(expected.size(), 4U);
  EXPECT_TRUE(find_part_boxes(cv::Mat1b(9, 9, uchar{0})).empty());
}

TEST(ConnectedParts, AreNotConnectedDiagonally) {
  cv::Mat1i labels;
  EXPECT_EQ(label_connected_parts(mask_of({"##..", "..#.", "..##"}), labels), 2);
  EXPECT_EQ(labels(0, 0), labels(0, 1));
  EXPECT_EQ(labels(1, 2), labels(2, 3));
  EXPECT_NE(labels(0, 0), labels(1, 2));
  EXPECT_EQ(labels(0, 3), 0);
  EXPECT_EQ(label_connected_parts(mask_of({"...."}), labels), 0);
}

}  // namespace
}  // namespace dvi
