#include "dvi/synthesize/exemplars.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/synthesize/adapt_to_boundary.h"

namespace dvi::synthesize {
namespace {

const cv::Size kSize(160, 96);
const cv::Rect kHole(60, 30, 36, 30);

/// An image of squares of 6 px, and a hole in it that is gray.
struct Example {
  cv::Mat3f truth{kSize}, color;
  cv::Mat1b unknown{kSize, uchar{0}}, usable;
  SurfaceGuide guide{cv::Mat1b(kSize, uchar{1}), cv::Mat2f(kSize, cv::Vec2f::all(std::numeric_limits<float>::quiet_NaN()))};

  Example() {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) truth(y, x) = cv::Vec3f::all((x / 6 + y / 6) % 2 == 0 ? 80.0F : 140.0F);
    unknown(kHole).setTo(255);
    usable = ~unknown;
    reset();
  }
  void reset() {
    color = truth.clone();
    color(kHole).setTo(cv::Scalar::all(110));
  }
  void complete() { complete_from_exemplars(color, {unknown, usable}, guide, 1); }
};

double mean_error(const cv::Mat3f& a, const cv::Mat3f& b) {
  return cv::norm(a, b, cv::NORM_L1) / (3.0 * static_cast<double>(a.total()));
}

TEST(Exemplars, APatternContinuesInTheHole) {
  Example example;
  example.complete();
  EXPECT_LT(mean_error(example.color(kHole), example.truth(kHole)), 6);  // 30 before
  example.color(kHole).setTo(0);
  example.truth(kHole).setTo(0);
  EXPECT_EQ(cv::norm(example.color, example.truth, cv::NORM_INF), 0);
}

TEST(Exemplars, TheSameSeedGivesTheSameColors) {
  Example a, b;
  a.complete();
  b.complete();
  EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0);
}

TEST(Exemplars, AreOfTheSameGroup) {
  Example example;
  // The lower half is another surface, which is red.
  const cv::Rect lower(0, 48, kSize.width, 48);
  example.truth(lower).setTo(cv::Scalar(0, 0, 200));
  example.guide.group(lower).setTo(2);
  example.reset();
  example.color(lower & kHole).setTo(cv::Scalar(20, 20, 180));  // as interpolated from its own surface
  example.complete();
  const cv::Rect red(kHole.x, 50, kHole.width, 10), squares(kHole.x, kHole.y, kHole.width, 16);
  EXPECT_LT(mean_error(example.color(red), example.truth(red)), 3);
  EXPECT_LT(std::abs(cv::mean(example.color(squares))[0] - 110), 15);
}

TEST(Exemplars, WithoutAnyColorsAreKept) {
  Example example;
  example.usable.setTo(0);
  const cv::Mat3f before = example.color.clone();
  example.complete();
  EXPECT_EQ(cv::norm(example.color, before, cv::NORM_INF), 0);
}

TEST(Exemplars, AHoleAtTheBorderOfASmallImageIsCompleted) {
  Example example;
  const cv::Rect corner(0, 0, 40, 24);
  cv::Mat3f color = example.truth(corner).clone();
  cv::Mat1b unknown(corner.size(), uchar{0});
  unknown(cv::Rect(0, 0, 12, 12)).setTo(255);
  color.setTo(cv::Scalar::all(0), unknown);
  complete_from_exemplars(color, {unknown, cv::Mat1b(~unknown)}, example.guide.of(corner), 1);
  EXPECT_GT(cv::mean(color, unknown)[0], 70);
}

/// The stripes of a road that converge at a vanishing point.
TEST(Exemplars, FollowThePerspectiveOfTheGround) {
  Example example;
  const double horizon = -20, height = 60;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const double depth = height / (y - horizon), left = (80 - x) * depth / 60;
      example.guide.ground(y, x) = {static_cast<float>(3 * depth), static_cast<float>(left)};
      example.truth(y, x) = cv::Vec3f::all(std::abs(left - std::floor(left)) < 0.5 ? 80.0F : 140.0F);
    }
  example.reset();
  example.complete();
  EXPECT_LT(mean_error(example.color(kHole), example.truth(kHole)), 8);
}

TEST(DivideForSearch, DistantPartsAreSeparate) {
  cv::Mat1b unknown(400, 1200, uchar{0});
  unknown(cv::Rect(20, 50, 30, 30)).setTo(255);
  unknown(cv::Rect(1000, 300, 20, 40)).setTo(255);
  const cv::Mat1b usable(~unknown);
  const std::vector<UnknownPart> parts = divide_for_search(unknown, usable);
  ASSERT_EQ(parts.size(), 2U);
  for (const UnknownPart& part : parts) {
    EXPECT_GE(cv::countNonZero(usable(part.box)), 30000);
    EXPECT_LT(part.box.width, 600);
  }
  EXPECT_EQ(cv::countNonZero(parts[0].unknown) + cv::countNonZero(parts[1].unknown), 1700);
}

TEST(DivideForSearch, APartWithFewUsablePixelsHasTheWholeImage) {
  cv::Mat1b unknown(100, 200, uchar{0});
  unknown(cv::Rect(0, 0, 150, 100)).setTo(255);
  const std::vector<UnknownPart> parts = divide_for_search(unknown, cv::Mat1b(~unknown));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].box, cv::Rect(0, 0, 200, 100));
  EXPECT_TRUE(divide_for_search(cv::Mat1b(100, 200, uchar{0}), unknown).empty());
}

TEST(AdaptToBoundary, RemovesASmallOffset) {
  Example example;
  example.color = example.truth.clone();
  cv::Mat3f hole = example.color(kHole);
  hole += cv::Scalar::all(8);
  adapt_to_boundary(example.color, example.unknown, example.guide);
  EXPECT_LT(mean_error(hole, example.truth(kHole)), 4);
}

TEST(AdaptToBoundary, KeepsThingsOfAnotherColor) {
  Example example;
  example.truth.setTo(cv::Scalar::all(30));
  example.color = example.truth.clone();
  example.color(kHole).setTo(cv::Scalar::all(220));
  adapt_to_boundary(example.color, example.unknown, example.guide);
  EXPECT_GT(cv::mean(example.color(kHole))[0], 200);
}

}  // namespace
}  // namespace dvi::synthesize
