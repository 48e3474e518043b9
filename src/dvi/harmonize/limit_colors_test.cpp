#include "dvi/harmonize/limit_colors.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {
namespace {

constexpr int kSide = 100;

cv::Mat1b hole_of(cv::Rect where) {
  cv::Mat1b mask(kSide, kSide, uchar{0});
  mask(where) = 255;
  return mask;
}

TEST(FindRangeAround, ExcludesTheTailsOfTheMargin) {
  cv::Mat3b image(kSide, kSide, cv::Vec3b(50, 100, 150));
  image(cv::Rect(0, 0, kSide, 30)) = cv::Vec3b(60, 110, 90);
  image(10, 50) = image(10, 51) = cv::Vec3b(255, 0, 255);  // a lamp
  const cv::Mat1b hole = hole_of({45, 45, 10, 10});
  image.setTo(cv::Scalar(1, 255, 1), hole);
  const ColorRange range = find_range_around(image, hole);
  EXPECT_EQ(range.low, cv::Vec3f(50, 100, 90));
  EXPECT_EQ(range.high, cv::Vec3f(60, 110, 150));
}

TEST(FindRangeAround, UsesNearbyPixelsOnly) {
  cv::Mat3b image(kSide, kSide, cv::Vec3b::all(200));
  image(cv::Rect(0, 0, 60, kSide)) = cv::Vec3b::all(100);
  const ColorRange range = find_range_around(image, hole_of({0, 40, 10, 10}));  // its margin ends at x = 49
  EXPECT_EQ(range.low, cv::Vec3f::all(100));
  EXPECT_EQ(range.high, cv::Vec3f::all(100));
}

TEST(FindRangeAround, ReturnsAllColorsIfTheHoleIsTheWholeFrame) {
  const ColorRange range = find_range_around(cv::Mat3b(kSide, kSide, cv::Vec3b::all(7)), hole_of({0, 0, kSide, kSide}));
  EXPECT_EQ(range.low, cv::Vec3f::all(0));
  EXPECT_EQ(range.high, cv::Vec3f::all(255));
}

TEST(FindRangeAround, ReturnsAllColorsWithoutAHole) {
  const ColorRange range = find_range_around(cv::Mat3b(kSide, kSide, cv::Vec3b::all(7)), hole_of({}));
  EXPECT_EQ(range.high, cv::Vec3f::all(255));
}

TEST(LimitCopies, AllowsColorsOfTheSurroundingsAndOfTheCopies) {
  const Region hole(hole_of({40, 40, 5, 1}));
  sample::Candidates candidates{hole, std::vector<sample::Candidate>(hole.size())};
  for (std::size_t i = 0; i < 4; ++i) candidates.leading[i] = {0, cv::Point2f(hole.pixels[i])};
  std::vector<cv::Vec3f> copies(hole.size(), cv::Vec3f::all(100));
  copies[0] = cv::Vec3f::all(300);
  cv::Mat3f color(kSide, kSide, cv::Vec3f::all(500));
  limit_copies({cv::Vec3f::all(80), cv::Vec3f::all(120)}, candidates, copies, color);
  EXPECT_EQ(color(40, 40), cv::Vec3f::all(255)) << "its copy is white";
  EXPECT_EQ(color(40, 41), cv::Vec3f::all(255)) << "next to a white copy";
  EXPECT_EQ(color(40, 42), cv::Vec3f::all(120));
  EXPECT_EQ(color(40, 44), cv::Vec3f::all(500)) << "not copied";
  EXPECT_EQ(color(50, 50), cv::Vec3f::all(500)) << "outside the hole";
  color = cv::Vec3f::all(90);
  color(40, 41) = cv::Vec3f(10, 90, 115);
  limit_copies({cv::Vec3f::all(80), cv::Vec3f::all(120)}, candidates, copies, color);
  EXPECT_EQ(color(40, 40), cv::Vec3f::all(90));
  EXPECT_EQ(color(40, 41), cv::Vec3f(80, 90, 115));
}

}  // namespace
}  // namespace dvi::harmonize
