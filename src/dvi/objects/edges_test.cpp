#include "dvi/objects/edges.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

constexpr int kRadiusPx = 4;
const cv::Size kSize(60, 40);
const cv::Rect kObjectRect(20, 10, 16, 20);
const cv::Vec3b kObjectColor = cv::Vec3b::all(40);

// Draws bright ground with a vertical dark line.
cv::Mat3b draw_ground(int line) {
  cv::Mat3b out(kSize, cv::Vec3b::all(140));
  out.colRange(line, line + 1) = cv::Vec3b::all(30);
  return out;
}

// Models a background that four views show identically, except in the hidden part.
BackgroundModel model(const cv::Mat3b& shown, const cv::Rect& hidden = {}) {
  std::vector<HalfSizePixel> pixels;
  std::vector<std::vector<cv::Vec3f>> colors;
  for (int y = 0; y < shown.rows; ++y)
    for (int x = 0; x < shown.cols; ++x) {
      pixels.push_back({{x, y}, Eigen::Vector3d::Zero()});
      colors.emplace_back(hidden.contains({x, y}) ? 0 : 4, shown(y, x));
    }
  return {pixels, colors, shown.size(), 3};
}

// Draws an object, and its mask without a number of rows at the top.
std::pair<cv::Mat3b, cv::Mat1b> draw_object(const cv::Mat3b& behind, int missing) {
  cv::Mat3b image = behind.clone();
  image(kObjectRect) = kObjectColor;
  cv::Mat1b mask(kSize, uchar{0});
  mask(cv::Rect(kObjectRect.x, kObjectRect.y + missing, kObjectRect.width, kObjectRect.height - missing)) = 255;
  return {image, mask};
}

TEST(Edges, AreAddedAsFarAsTheyDiffer) {
  for (const int missing : {1, 2, 3}) {
    const cv::Mat3b behind = draw_ground(50);
    const auto [image, mask] = draw_object(behind, missing);
    const cv::Mat1b found = add_missing_edges(mask, model(behind), image, kRadiusPx);
    EXPECT_LE(cv::countNonZero(found(kObjectRect) == 0), 2) << missing << ": all but its corners";
    cv::Mat1b beyond = found.clone();
    beyond(kObjectRect) = 0;
    EXPECT_LE(cv::countNonZero(beyond), 3 * kObjectRect.width / 2) << missing;
  }
}

TEST(Edges, DoNotIncludeLinesThatAreDisplacedByOnePixel) {
  const auto [image, mask] = draw_object(draw_ground(27), 0);
  const cv::Mat1b found = add_missing_edges(mask, model(draw_ground(28)), image, kRadiusPx);
  EXPECT_EQ(cv::norm(found, mask, cv::NORM_INF), 0);
}

TEST(Edges, DoNotIncludeLinesThatLeadAway) {
  const auto [image, mask] = draw_object(draw_ground(27), 0);
  const cv::Mat1b found = add_missing_edges(mask, model(draw_ground(50)), image, kRadiusPx);
  EXPECT_EQ(cv::norm(found, mask, cv::NORM_INF), 0);
}

TEST(Edges, AreNotAddedWhereTheBackgroundIsUnobserved) {
  const cv::Mat3b behind = draw_ground(50);
  const auto [image, mask] = draw_object(behind, 2);
  const cv::Rect above(0, 0, kSize.width, kObjectRect.y + 2);
  EXPECT_EQ(cv::norm(add_missing_edges(mask, model(behind, above), image, kRadiusPx), mask, cv::NORM_INF), 0);
  const cv::Rect everywhere({}, kSize);
  EXPECT_EQ(cv::norm(add_missing_edges(mask, model(behind, everywhere), image, kRadiusPx), mask, cv::NORM_INF), 0);
}

TEST(Edges, AreSearchedWithinHalfADegree) {
  EXPECT_EQ(compute_edge_search_radius_px({621, 187}), 4);
  EXPECT_EQ(compute_edge_search_radius_px({320, 180}), 2);
  EXPECT_EQ(compute_edge_search_radius_px({80, 48}), 1);
}

TEST(Edges, MustDifferByMoreThanTheRestOfTheView) {
  const cv::Mat3b behind = draw_ground(50);
  auto [image, mask] = draw_object(behind, 2);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      if (!kObjectRect.contains({x, y})) image(y, x) += cv::Vec3b::all(110);  // another exposure of the whole background
  EXPECT_EQ(cv::norm(add_missing_edges(mask, model(behind), image, kRadiusPx), mask, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::objects
