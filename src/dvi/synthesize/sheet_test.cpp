#include "dvi/synthesize/sheet.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::synthesize {
namespace {

/// Rows of colors, and every 40 columns a mark: a road with lane lines.
cv::Vec3f road(int x, int y) {
  const float mark = x % 40 < 12 && y / 8 == 5 ? 120 : 0;
  return cv::Vec3f::all(static_cast<float>(60 + 10 * (y / 16)) + mark);
}

Sheet road_with(cv::Rect missing) {
  Sheet sheet({240, 96});
  sheet.known.setTo(255);
  sheet.known(missing).setTo(0);
  for (int y = 0; y < sheet.known.rows; ++y)
    for (int x = 0; x < sheet.known.cols; ++x)
      if (sheet.known(y, x) != 0) sheet.color(y, x) = road(x, y);
  return sheet;
}

TEST(Sheet, WhatRepeatsIsCompletedExactly) {
  const cv::Rect missing(100, 20, 36, 48);
  Sheet sheet = road_with(missing);
  complete(sheet, {{{-56, 0}, {-40, 0}, {24, 0}, {64, 0}}}, 20);
  EXPECT_EQ(cv::countNonZero(sheet.known == 0), 0);
  for (int y = missing.y; y < missing.br().y; ++y)
    for (int x = missing.x; x < missing.br().x; ++x)
      EXPECT_NEAR(cv::norm(sheet.color(y, x) - road(x, y)), 0, 0.5) << x << ", " << y;
}

TEST(Sheet, WhatIsCopiedFromTheSunMeetsTheShadeWithoutStepAndWithItsContrast) {
  // Bright left, dark right, with the same relative texture; the offset leads from the dark hole to the bright side.
  const auto texture = [](int x, int y) { return 1 + 0.2F * static_cast<float>(x % 8 < 4) * static_cast<float>(y % 8 < 4); };
  const auto light = [](int x) { return x < 64 ? 180.0F : 45.0F; };
  Sheet sheet({240, 96});
  sheet.known.setTo(255);
  const cv::Rect missing(120, 32, 24, 32);
  sheet.known(missing).setTo(0);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 240; ++x)
      if (sheet.known(y, x) != 0) sheet.color(y, x) = cv::Vec3f::all(light(x) * texture(x, y));
  complete(sheet, {{{-88, 0}}}, 20);
  for (int y = missing.y; y < missing.br().y; ++y)
    for (int x = missing.x; x < missing.br().x; ++x)
      EXPECT_NEAR(sheet.color(y, x)[0], 45 * texture(x, y), 6) << x << ", " << y;  // 6: the offset added for black
}

TEST(Sheet, WhatIsKnownStays) {
  const Sheet before = road_with({100, 20, 36, 48});
  Sheet after = before;
  complete(after, {{{-16, 0}, {16, 0}}, {{-16, 0}, {16, 0}}}, 20);
  for (int y = 0; y < before.known.rows; ++y)
    for (int x = 0; x < before.known.cols; ++x)
      EXPECT_TRUE(before.known(y, x) == 0 || after.color(y, x) == before.color(y, x)) << x << " " << y;
}

TEST(Sheet, OffsetsThatLeadNowhereLeaveItAsItIs) {
  Sheet sheet({64, 32});
  complete(sheet, {{{-16, 0}, {16, 8}}, {{400, 0}, {-64, 32}}}, 20);
  EXPECT_EQ(cv::countNonZero(sheet.known), 0);
  EXPECT_EQ(cv::norm(sheet.color, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::synthesize
