#include "dvi/synthesize/texture_tile.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::synthesize {
namespace {

/// The color of a road with lane lines: it depends on the row, and has a mark every 40 columns.
cv::Vec3f road(int x, int y) {
  const float mark = x % 40 < 12 && y / 8 == 5 ? 120 : 0;
  return cv::Vec3f::all(static_cast<float>(60 + 10 * (y / 16)) + mark);
}

TextureTile road_with(cv::Rect missing) {
  TextureTile tile({240, 96});
  tile.known.setTo(255);
  tile.known(missing).setTo(0);
  for (int y = 0; y < tile.known.rows; ++y)
    for (int x = 0; x < tile.known.cols; ++x)
      if (tile.known(y, x) != 0) tile.color(y, x) = road(x, y);
  return tile;
}

TEST(TextureTile, RepeatedPatternsAreCompletedExactly) {
  const cv::Rect missing(100, 20, 36, 48);
  TextureTile tile = road_with(missing);
  complete(tile, {{{-56, 0}, {-40, 0}, {24, 0}, {64, 0}}}, 20);
  EXPECT_EQ(cv::countNonZero(tile.known == 0), 0);
  for (int y = missing.y; y < missing.br().y; ++y)
    for (int x = missing.x; x < missing.br().x; ++x)
      EXPECT_NEAR(cv::norm(tile.color(y, x) - road(x, y)), 0, 0.5) << x << ", " << y;
}

TEST(TextureTile, CopiesFromSunlitAreasAreAdaptedToShadow) {
  // Bright left, dark right, with the same relative texture. The hole is dark, its copies are bright.
  const auto texture = [](int x, int y) { return 1 + 0.2F * static_cast<float>(x % 8 < 4) * static_cast<float>(y % 8 < 4); };
  const auto light = [](int x) { return x < 64 ? 180.0F : 45.0F; };
  TextureTile tile({240, 96});
  tile.known.setTo(255);
  const cv::Rect missing(120, 32, 24, 32);
  tile.known(missing).setTo(0);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 240; ++x)
      if (tile.known(y, x) != 0) tile.color(y, x) = cv::Vec3f::all(light(x) * texture(x, y));
  complete(tile, {{{-88, 0}}}, 20);
  for (int y = missing.y; y < missing.br().y; ++y)
    for (int x = missing.x; x < missing.br().x; ++x)
      EXPECT_NEAR(tile.color(y, x)[0], 45 * texture(x, y), 6) << x << ", " << y;  // 6 is due to black_levels
}

TEST(TextureTile, KnownPixelsAreUnchanged) {
  const TextureTile before = road_with({100, 20, 36, 48});
  TextureTile after = before;
  complete(after, {{{-16, 0}, {16, 0}}, {{-16, 0}, {16, 0}}}, 20);
  for (int y = 0; y < before.known.rows; ++y)
    for (int x = 0; x < before.known.cols; ++x)
      EXPECT_TRUE(before.known(y, x) == 0 || after.color(y, x) == before.color(y, x)) << x << " " << y;
}

TEST(TextureTile, OffsetsWithoutKnownPixelsChangeNothing) {
  TextureTile tile({64, 32});
  complete(tile, {{{-16, 0}, {16, 8}}, {{400, 0}, {-64, 32}}}, 20);
  EXPECT_EQ(cv::countNonZero(tile.known), 0);
  EXPECT_EQ(cv::norm(tile.color, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::synthesize
