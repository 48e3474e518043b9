#include "dvi/harmonize/illumination_change.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/harmonize/fuse.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::harmonize {
namespace {

constexpr int kColumns = 320, kRows = 240;

/// Another drive with a camera at the position of the target's. The left half of the image is a surface that faces the cameras,
/// the right half a wall that recedes from them. Each half has a hole in its middle.
struct TwoDrives {
  cv::Mat3b truth = waves(kColumns, kRows, 1, 20);
  cv::Mat1b hole = cv::Mat1b(kRows, kColumns, uchar{0});
  depth::DepthMap depth{cv::Mat1f(kRows, kColumns, 10.0F), cv::Mat1f(kRows, kColumns, 0.01F)};
  cv::Mat3b other;

  TwoDrives() {
    hole(left_hole()) = 255;
    hole(right_hole()) = 255;
    for (int x = kColumns / 2; x < kColumns; ++x) depth.z.col(x) = 10 / (1 + 0.02F * static_cast<float>(x - kColumns / 2));
    truth = 0.5 * truth + cv::Scalar::all(60);
    other = truth.clone();
  }
  static cv::Rect left_hole() { return {60, 100, 40, 40}; }
  static cv::Rect right_hole() { return {220, 100, 40, 40}; }

  struct Found {
    IlluminationChange illumination;
    Fused fused;
    cv::Vec3f gain(cv::Point at) const { return illumination.drives.at(1).gain.at(static_cast<std::size_t>(index(at))); }
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
    const IlluminationChange illumination = compare_illumination({views, 0, depth, visibility}, candidates);
    return {illumination, fuse({views, 0, depth, visibility}, candidates, illumination), candidates.hole.index};
  }
  double max_error(const Found& found) const {
    double out = 0;
    for (std::size_t i = 0; i < found.fused.color.size(); ++i)
      for (int c = 0; c < 3; ++c)
        out = std::max<double>(out, std::abs(found.fused.color[i][c] - truth(found.fused.candidates.hole.pixels[i])[c]));
    return out;
  }
};

TEST(CompareIllumination, EachOrientationHasItsOwnGain) {
  TwoDrives drives;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) drives.other(y, x) = cv::Vec3f(drives.truth(y, x)) * (x < kColumns / 2 ? 0.8F : 0.5F);
  const TwoDrives::Found found = drives.run();
  EXPECT_NEAR(found.gain({80, 120})[1], 1 / 0.8, 0.03);
  EXPECT_NEAR(found.gain({240, 120})[1], 1 / 0.5, 0.08);
  EXPECT_LT(drives.max_error(found), 10) << "rounding to gray levels, and the prior";
}

TEST(CompareIllumination, IgnoresTheSky) {
  TwoDrives drives;
  drives.depth.z.rowRange(0, 60) = depth::DepthMap::kInfinity;
  drives.truth.rowRange(0, 60) = cv::Scalar::all(240);
  drives.other.rowRange(0, 60) = cv::Scalar::all(120);
  const TwoDrives::Found found = drives.run();
  EXPECT_NEAR(found.gain({80, 120})[1], 1, 0.01);
  EXPECT_LT(found.illumination.max_surface_level, 200);
}

TEST(CompareIllumination, IsNoneForTheSameIllumination) {
  const TwoDrives::Found found = TwoDrives().run();
  for (const cv::Point at : {cv::Point(80, 120), cv::Point(240, 120)})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.gain(at)[c], 1, 0.01);
}

TEST(CompareIllumination, ChangedSurfacesAreNotCopied) {
  TwoDrives drives;
  Random random(3);
  for (int y = 0; y < kRows; y += 16)
    for (int x = kColumns / 2; x < kColumns; x += 16)
      drives.other(cv::Rect(x, y, 16, 16)) = cv::Vec3b::all(static_cast<uchar>(9 * std::exp(random.uniform(0, 3.3))));
  const TwoDrives::Found found = drives.run();
  EXPECT_GT(found.gain({80, 120})[0], 0);
  EXPECT_EQ(found.gain({240, 120})[0], 0);
  EXPECT_TRUE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 80))].found());
  EXPECT_FALSE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 240))].found());
}

TEST(CompareIllumination, FramesOfTheSameDriveAreNotCompared) { EXPECT_TRUE(TwoDrives().run(0).illumination.drives.empty()); }

TEST(CompareIllumination, CopiesBrighterThanAnySurfaceAreNotUsed) {
  TwoDrives drives;
  drives.other(TwoDrives::left_hole()) = cv::Vec3b(255, 255, 255);
  const TwoDrives::Found found = drives.run();
  EXPECT_LT(found.illumination.max_surface_level, 230);
  EXPECT_FALSE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 80))].found());
  EXPECT_TRUE(found.fused.candidates.leading[static_cast<std::size_t>(found.index(120, 240))].found());
}

}  // namespace
}  // namespace dvi::harmonize
