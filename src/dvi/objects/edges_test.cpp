#include "dvi/objects/edges.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

constexpr int kReach = 4;
const cv::Size kStill(60, 40);
const cv::Rect kObjectRect(20, 10, 16, 20);
const cv::Vec3f kPaint = cv::Vec3f::all(40);

// Bright ground with a dark line across, seen alike by four others.
Patch lined(int line) {
  Patch out(kStill, cv::Vec3f::all(140));
  out.colRange(line, line + 1) = cv::Vec3f::all(30);
  return out;
}

Usual seen_by_others(const Patch& shown, const cv::Rect& hidden = {}) {
  std::vector<HalfSizePixel> places;
  std::vector<std::vector<cv::Vec3f>> seen;
  for (int y = 0; y < shown.rows; ++y)
    for (int x = 0; x < shown.cols; ++x) {
      places.push_back({{x, y}, Eigen::Vector3d::Zero()});
      seen.emplace_back(hidden.contains({x, y}) ? 0 : 4, shown(y, x));
    }
  return {places, seen, shown.size(), 3};
}

// An object, of whose mask so many rows at the top are missing.
std::pair<Patch, cv::Mat1b> object_before(const Patch& behind, int missing) {
  Patch image = behind.clone();
  image(kObjectRect) = kPaint;
  cv::Mat1b mask(kStill, uchar{0});
  mask(cv::Rect(kObjectRect.x, kObjectRect.y + missing, kObjectRect.width, kObjectRect.height - missing)) = 255;
  return {image, mask};
}

TEST(Edges, AreFoundAsFarAsTheyDiffer) {
  for (const int missing : {1, 2, 3}) {
    const Patch behind = lined(50);
    const auto [image, mask] = object_before(behind, missing);
    const cv::Mat1b found = with_edges(mask, seen_by_others(behind), image, kReach);
    EXPECT_LE(cv::countNonZero(found(kObjectRect) == 0), 2) << missing << ": but its corners";
    cv::Mat1b beyond = found.clone();
    beyond(kObjectRect) = 0;
    EXPECT_LE(cv::countNonZero(beyond), 3 * kObjectRect.width / 2) << missing;
  }
}

TEST(Edges, AreNotLinesThatStandAPixelBesideWhereOthersShowThem) {
  const auto [image, mask] = object_before(lined(27), 0);
  const cv::Mat1b found = with_edges(mask, seen_by_others(lined(28)), image, kReach);
  EXPECT_EQ(cv::norm(found, mask, cv::NORM_INF), 0);
}

TEST(Edges, AreNotLinesThatLeadAway) {
  const auto [image, mask] = object_before(lined(27), 0);
  const cv::Mat1b found = with_edges(mask, seen_by_others(lined(50)), image, kReach);
  EXPECT_EQ(cv::norm(found, mask, cv::NORM_INF), 0);
}

TEST(Edges, AreNotFoundWhereNobodySawTheBackground) {
  const Patch behind = lined(50);
  const auto [image, mask] = object_before(behind, 2);
  const cv::Rect above(0, 0, kStill.width, kObjectRect.y + 2);
  EXPECT_EQ(cv::norm(with_edges(mask, seen_by_others(behind, above), image, kReach), mask, cv::NORM_INF), 0);
  const cv::Rect everywhere({}, kStill);
  EXPECT_EQ(cv::norm(with_edges(mask, seen_by_others(behind, everywhere), image, kReach), mask, cv::NORM_INF), 0);
}

TEST(Edges, AreLookedForHalfADegreeAround) {
  EXPECT_EQ(edge_reach({621, 187}), 4);
  EXPECT_EQ(edge_reach({320, 180}), 2);
  EXPECT_EQ(edge_reach({80, 48}), 1);
}

TEST(Edges, DifferByMoreThanTheRestOfTheView) {
  const Patch behind = lined(50);
  auto [image, mask] = object_before(behind, 2);
  for (int y = 0; y < kStill.height; ++y)
    for (int x = 0; x < kStill.width; ++x)
      if (!kObjectRect.contains({x, y})) image(y, x) += cv::Vec3f::all(110);  // another light, for all of it
  EXPECT_EQ(cv::norm(with_edges(mask, seen_by_others(behind), image, kReach), mask, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::objects
