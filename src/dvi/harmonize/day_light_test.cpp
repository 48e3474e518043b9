#include "dvi/harmonize/day_light.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::harmonize {
namespace {

constexpr int kColumns = 320, kRows = 240;

/// Another drive that stood where the target does. The left half of what both show faces them, the right half is a wall that
/// goes away from them; a hole is in the middle of each.
struct TwoDays {
  cv::Mat3b truth = waves(kColumns, kRows, 1, 20);
  cv::Mat1b hole = cv::Mat1b(kRows, kColumns, uchar{0});
  depth::DepthMap depth{cv::Mat1f(kRows, kColumns, 10.0F), cv::Mat1f(kRows, kColumns, 0.01F)};
  cv::Mat3b other;

  TwoDays() {
    hole(left_hole()) = 255;
    hole(right_hole()) = 255;
    for (int x = kColumns / 2; x < kColumns; ++x) depth.z.col(x) = 10 / (1 + 0.02F * static_cast<float>(x - kColumns / 2));
    truth = 0.5 * truth + cv::Scalar::all(60);
    other = truth.clone();
  }
  static cv::Rect left_hole() { return {60, 100, 40, 40}; }
  static cv::Rect right_hole() { return {220, 100, 40, 40}; }

  struct Found {
    DayLight light;
    Fused fused;
    cv::Vec3f gain(cv::Point at) const { return light.drives.at(1).gain.at(static_cast<std::size_t>(index(at))); }
    cv::Mat1i index;
  };
  Found run(int drive = 1) const {
    FlatScene scene(truth, hole);
    scene.add_source(0, other, drive);
    sample::Candidates candidates{Region(hole), {}, 0};
    for (const cv::Point p : candidates.hole.pixels) candidates.leading.push_back({1, cv::Point2f(p)});
    const Lazy<depth::VisibilityMap> visibility(
        2, [&](std::size_t) { return depth::make_visibility_map(depth, cv::Mat1b(hole.size(), uchar{0})); });
    const Views views = scene.lazy();
    const DayLight light = compare_days({views, 0, depth, visibility}, candidates);
    return {light, fuse({views, 0, depth, visibility}, candidates, light), candidates.hole.index};
  }
  double worst(const Found& found) const {
    double out = 0;
    for (std::size_t i = 0; i < found.fused.color.size(); ++i)
      for (int c = 0; c < 3; ++c)
        out = std::max<double>(out, std::abs(found.fused.color[i][c] - truth(found.fused.candidates.hole.pixels[i])[c]));
    return out;
  }
};

TEST(DayLight, EachDirectionOfSurfacesHasItsOwn) {
  TwoDays days;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) days.other(y, x) = cv::Vec3f(days.truth(y, x)) * (x < kColumns / 2 ? 0.8F : 0.5F);
  const TwoDays::Found found = days.run();
  EXPECT_NEAR(found.gain({80, 120})[1], 1 / 0.8, 0.03);
  EXPECT_NEAR(found.gain({240, 120})[1], 1 / 0.5, 0.08);
  EXPECT_LT(days.worst(found), 10) << "rounded to gray levels, drawn to 1 by few surfaces";
}

TEST(DayLight, TheSkyTellsNothing) {
  TwoDays days;
  days.depth.z.rowRange(0, 60) = depth::DepthMap::kInfinity;
  days.truth.rowRange(0, 60) = cv::Scalar::all(240);
  days.other.rowRange(0, 60) = cv::Scalar::all(120);
  const TwoDays::Found found = days.run();
  EXPECT_NEAR(found.gain({80, 120})[1], 1, 0.01);
  EXPECT_LT(found.light.brightest, 200);
}

TEST(DayLight, TheSameLightStays) {
  const TwoDays::Found found = TwoDays().run();
  for (const cv::Point at : {cv::Point(80, 120), cv::Point(240, 120)})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.gain(at)[c], 1, 0.01);
}

TEST(DayLight, WhatHasChangedIsNotCopied) {
  TwoDays days;
  Random random(3);
  for (int y = 0; y < kRows; y += 16)
    for (int x = kColumns / 2; x < kColumns; x += 16)
      days.other(cv::Rect(x, y, 16, 16)) = cv::Vec3b::all(static_cast<uchar>(9 * std::exp(random.uniform(0, 3.3))));
  const TwoDays::Found found = days.run();
  EXPECT_GT(found.gain({80, 120})[0], 0);
  EXPECT_EQ(found.gain({240, 120})[0], 0);
  EXPECT_TRUE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 80))].found());
  EXPECT_FALSE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 240))].found());
}

TEST(DayLight, FramesOfTheSameDriveAreNotCompared) { EXPECT_TRUE(TwoDays().run(0).light.drives.empty()); }

TEST(DayLight, CopiesBrighterThanAnySurfaceAreNotUsed) {
  TwoDays days;
  days.other(TwoDays::left_hole()) = cv::Vec3b(255, 255, 255);
  const TwoDays::Found found = days.run();
  EXPECT_LT(found.light.brightest, 230);
  EXPECT_FALSE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 80))].found());
  EXPECT_TRUE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 240))].found());
}

}  // namespace
}  // namespace dvi::harmonize
