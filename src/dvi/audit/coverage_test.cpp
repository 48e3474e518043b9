#include "dvi/audit/coverage.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/testing/memory_views.h"

namespace dvi::audit {
namespace {

constexpr int kWidth = 160, kHeight = 96;

/// A wall 10 m ahead of a camera that moves sideways by `pixels` per frame, with a hole in each image.
class Wall {
 public:
  void add(int pixels, cv::Rect hole, int drive = 0) {
    View view;
    view.sequence = view.drive = drive;
    view.frame = views_.size();
    view.camera = {kWidth, kHeight, 100, 100, kWidth / 2.0, kHeight / 2.0, {}};
    view.camera_from_world.t.x() = pixels * 0.1;
    views_.push_back(view);
    images_.emplace_back(kHeight, kWidth, cv::Vec3b(1, 2, 3));
    masks_.emplace_back(kHeight, kWidth, uchar{0});
    masks_.back()(hole) = 255;
  }
  Coverage predict(int step) const { return predict_coverage(memory_views(views_, images_, masks_), map(), {.step = step}); }

 private:
  static map::StaticMap map() {
    map::StaticMap out;
    map::StaticMap::Tile tile;
    for (float y = -8; y <= 8; y += 0.1F)
      for (float x = -30; x <= 30; x += 0.1F) {
        map::MapPoint point;
        point.position = {x, y, 10};
        tile.bounds.extend(point.position);
        out.points.push_back(point);
      }
    tile.last = out.points.size();
    out.tiles.push_back(tile);
    return out;
  }

  std::vector<View> views_;
  std::vector<cv::Mat3b> images_;
  std::vector<cv::Mat1b> masks_;
};

TEST(Coverage, CountsPixelsObservedByOtherFrames) {
  const cv::Rect hole(60, 32, 40, 32);
  Wall wall;
  wall.add(0, hole);
  wall.add(20, hole);  // half of the hole is outside this mask
  for (const int step : {1, 2}) {
    const Coverage found = wall.predict(step);
    ASSERT_EQ(found.frames.size(), 2U);
    EXPECT_NEAR(found.frames[0].hole.copied, 0.5, 0.02);
    EXPECT_NEAR(found.total.copied + found.total.unobserved, 1, 1e-9);
    EXPECT_NEAR(found.frames[0].image_share, 40.0 * 32 / (kWidth * kHeight), 0.01);
  }
}

TEST(Coverage, SeparatesSourceDrives) {
  const cv::Rect hole(60, 32, 40, 32);
  Wall wall;
  wall.add(0, hole);
  wall.add(20, hole);
  wall.add(0, {}, 1);
  const Coverage found = wall.predict(2);
  ASSERT_EQ(found.frames.size(), 2U) << "only those of the target drive";
  EXPECT_NEAR(found.total.copied, 0.5, 0.02);
  EXPECT_NEAR(found.total.copied_elsewhere, 0.5, 0.02);
  EXPECT_NEAR(found.total.unobserved, 0, 0.01);
}

TEST(Coverage, IsZeroForFramesWithoutAHole) {
  Wall wall;
  wall.add(0, {});
  wall.add(5, {});
  const Coverage found = wall.predict(2);
  EXPECT_EQ(found.total.copied, 0);
  EXPECT_EQ(found.total.unobserved, 0);
  EXPECT_EQ(found.frames[0].image_share, 0);
}

TEST(CoverageChart, HasBarsWithTheHeightOfTheShares) {
  const auto amount = [](const HoleShares& hole) {
    Coverage coverage;
    coverage.frames = {{0, 0.1, hole}};
    cv::Mat1b found;
    cv::inRange(draw_coverage_chart(coverage, {7}), cv::Scalar(180, 120, 40), cv::Scalar(180, 120, 40), found);
    return cv::countNonZero(found);
  };
  const int none = amount({0, 0, 1}), half = amount({0.5, 0, 0.5}), all = amount({1, 0, 0});
  EXPECT_GT(half, none);
  EXPECT_NEAR(half - none, (all - none) / 2, 24);
  Coverage longer;
  longer.frames.resize(3000);
  EXPECT_GE(draw_coverage_chart(longer, std::vector<int>(3000, 5)).cols, 3000) << "a long drive has one bar per frame";
}

}  // namespace
}  // namespace dvi::audit
