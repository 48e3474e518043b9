#include "dvi/drive/outline.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include <opencv2/core.hpp>

namespace dvi {
namespace {

TEST(Outline, DrawsTheMaskItWasMadeOf) {
  std::mt19937 random(7);
  for (const double share : {0.0, 0.3, 1.0}) {
    cv::Mat1b mask(13, 17, uchar{0});
    std::bernoulli_distribution set(share);
    for (uchar& pixel : cv::Mat_<uchar>(mask)) pixel = set(random) ? 255 : 0;
    cv::Mat1b drawn(mask.size(), uchar{0});
    draw(to_outline(mask), drawn);
    EXPECT_EQ(cv::norm(mask, drawn, cv::NORM_INF), 0) << share;
  }
}

TEST(Outline, OfAPartEqualsThatOfTheWholeImage) {
  std::mt19937 random(3);
  const cv::Size size(9, 7);
  for (int turn = 0; turn < 300; ++turn) {
    const auto any = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
    const cv::Point corner(any(0, 8), any(0, 6));
    const cv::Rect part(corner, cv::Size(any(1, 9 - corner.x), any(1, 7 - corner.y)));
    cv::Mat1b whole(size, uchar{0});
    for (int y = part.y; y < part.br().y; ++y)
      for (int x = part.x; x < part.br().x; ++x) whole(y, x) = any(0, 3) > 0 ? 255 : 0;
    EXPECT_EQ(to_outline(cv::Mat1b(whole(part)), part.tl(), size).runs, to_outline(whole).runs) << part;
  }
  EXPECT_EQ(to_outline(cv::Mat1b(), {0, 0}, size).runs, std::vector<std::uint32_t>{63});
}

TEST(Outline, OfPolygonsHasThePixelsWithCentersInside) {
  const cv::Size size(20, 12);
  const auto drawn = [&](const std::vector<Polygon>& polygons) {
    cv::Mat1b mask(size, uchar{0});
    draw(to_outline(polygons, size), mask);
    return mask;
  };
  cv::Mat1b square(size, uchar{0});
  square(cv::Rect(3, 2, 5, 4)) = 255;
  EXPECT_EQ(cv::norm(drawn({{{3, 2}, {8, 2}, {8, 6}, {3, 6}}}), square, cv::NORM_INF), 0);
  square(cv::Rect(15, 0, 5, 12)) = 255;
  EXPECT_EQ(
      cv::norm(drawn({{{3, 2}, {8, 2}, {8, 6}, {3, 6}}, {{15, -1e6}, {1e6, -5}, {1e6, 30}, {15, 1e6}}}), square, cv::NORM_INF),
      0)
      << "parts are merged and clipped at the border of the image";
  const cv::Mat1b triangle = drawn({{{0, 0}, {12, 0}, {0, 12}}});
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const bool on_the_edge = x + y == 11;
      EXPECT_TRUE(on_the_edge || (triangle(y, x) != 0) == (x + y < 11)) << x << ' ' << y;
    }
  EXPECT_EQ(cv::countNonZero(drawn({{{-5, -5}, {-1, -5}, {-1, -1}}, {{4, 4}, {9, 9}}, {}})), 0);
}

TEST(Outline, IsClippedToAMaskOfAnotherSize) {
  cv::Mat1b small(4, 4, uchar{0});
  draw(to_outline(cv::Mat1b(9, 8, uchar{255})), small);
  EXPECT_EQ(cv::countNonZero(small), 16);
}

TEST(Outline, HasHullsClippedAtTheNearPlane) {
  const Camera camera{.width = 40, .height = 30, .fx = 20, .fy = 20, .cx = 20, .cy = 15};
  cv::Mat1b mask(30, 40, uchar{0});
  EXPECT_FALSE(draw_hull({{0, 0, 0.1}, {1, 1, -5}}, camera, mask));
  EXPECT_EQ(cv::countNonZero(mask), 0);
  EXPECT_TRUE(draw_hull({{-1, -1, 4}, {1, -1, 4}, {1, 1, 4}, {-1, 1, 4}, {0, 0, -1}}, camera, mask));
  EXPECT_EQ(cv::countNonZero(mask), 11 * 11);
}

TEST(Outline, DrawsCoordinatesThatAreNotNumbers) {
  EXPECT_EQ(to_drawing_pixel(std::numeric_limits<double>::quiet_NaN(), 1e300), cv::Point(-100000, 100000));
  EXPECT_EQ(to_drawing_pixel(2.6, -0.4), cv::Point(3, 0));
}

}  // namespace
}  // namespace dvi
