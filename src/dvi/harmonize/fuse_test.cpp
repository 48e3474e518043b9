#include "dvi/harmonize/fuse.h"

#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::harmonize {
namespace {

SourceColor gray(float level, float weight = 0.5F) { return {cv::Vec3f::all(level), weight}; }

TEST(FindAgreement, AveragesColorsThatAgreeByWeight) {
  const Agreement out = find_agreement(std::vector{gray(100, 0.75F), gray(104, 0.25F)});
  EXPECT_EQ(out.leading, 0);
  EXPECT_EQ(out.sources, 2);
  EXPECT_FLOAT_EQ(out.color[1], 101);
  EXPECT_FLOAT_EQ(out.spread, 4);
}

TEST(FindAgreement, IgnoresOneOutlierOfThree) {
  for (std::size_t odd = 0; odd < 3; ++odd) {
    std::vector<SourceColor> shown{gray(100, 0.6F), gray(100), gray(100)};
    shown[odd].color = cv::Vec3f::all(180);
    const Agreement out = find_agreement(shown);
    EXPECT_EQ(out.leading, odd == 0 ? 1 : 0);
    EXPECT_NEAR(out.color[0], 100, 1e-3);
    EXPECT_EQ(out.sources, 2);
    EXPECT_GT(out.spread, 39);
  }
}

TEST(FindAgreement, SelectsTheLargestWeightIfNoColorsAgree) {
  const Agreement out = find_agreement(std::vector{gray(100, 0.6F), gray(150), gray(200)});
  EXPECT_EQ(out.leading, 0);
  EXPECT_NEAR(out.color[0], 100, 1e-3);
  EXPECT_EQ(out.sources, 1);
}

TEST(FindAgreement, ReturnsASingleColor) {
  const Agreement out = find_agreement(std::vector<SourceColor>{gray(100), {}, {}});
  EXPECT_NEAR(out.color[0], 100, 1e-3);
  EXPECT_EQ(out.sources, 1);
  EXPECT_EQ(out.spread, 0);
}

/// A hole in a stationary scene: sources show each pixel at the same image position.
struct Still {
  cv::Mat1b hole = cv::Mat1b(60, 80, uchar{0});
  FlatScene scene;
  sample::Candidates candidates;

  explicit Still(const std::vector<cv::Mat3b>& sources, const cv::Mat3b& truth) : scene(truth, hole) {
    hole(cv::Rect(30, 20, 20, 20)) = 255;
    for (const cv::Mat3b& source : sources) scene.add_source(0, source);
    candidates = {Region(hole), {}, sources.size() - 1};
    for (const cv::Point p : candidates.hole.pixels)
      for (int k = 1; k <= static_cast<int>(sources.size()); ++k)
        (k == 1 ? candidates.leading : candidates.extra).push_back({k, cv::Point2f(p)});
  }
  Fused run() const { return fuse({scene.lazy(), 0, {}, {}}, candidates, {}); }
};

double mean_square_error(const Still& still, const Fused& fused, const cv::Mat3b& truth) {
  double sum = 0;
  for (std::size_t i = 0; i < fused.color.size(); ++i) {
    const cv::Vec3f error = fused.color[i] - cv::Vec3f(truth(still.candidates.hole.pixels[i]));
    sum += error.dot(error) / 3;
  }
  return sum / static_cast<double>(fused.color.size());
}

TEST(Fuse, AveragingReducesNoise) {
  const cv::Mat3b truth = waves(80, 60, 1);
  Random random(5);
  std::vector<cv::Mat3b> noisy;
  for (int k = 0; k < 3; ++k) {
    noisy.push_back(truth.clone());
    for (cv::Vec3b& p : noisy.back())
      for (int c = 0; c < 3; ++c) p[c] = static_cast<uchar>(p[c] + random.below(5) - 2);  // variance 2
  }
  const double noise = 2;
  const Still one({noisy[0]}, truth), three(noisy, truth);
  EXPECT_NEAR(mean_square_error(one, one.run(), truth), noise, 0.3);
  EXPECT_NEAR(mean_square_error(three, three.run(), truth), noise / 3, 0.1);
}

TEST(Fuse, SaturatedSourcesAreAvoided) {
  const cv::Mat3b truth(60, 80, cv::Vec3b::all(240)), white(60, 80, cv::Vec3b::all(255));
  const Still some({white, truth}, truth);
  for (const cv::Vec3f& color : some.run().color) EXPECT_NEAR(color[0], 240, 1);
  const Still all({white, white}, truth);
  for (const cv::Vec3f& color : all.run().color) EXPECT_EQ(color[0], 255);
}

TEST(Fuse, TransfersSourcesToTheIlluminationOfTheTarget) {
  const cv::Mat3b truth(60, 80, cv::Vec3b::all(100)), dark(60, 80, cv::Vec3b::all(50));
  Still still({truth, dark}, truth);
  still.scene.views[2].gain = {2, 2, 2};
  const Fused out = still.run();
  EXPECT_EQ(out.sources[0], 2);
  EXPECT_NEAR(out.color[0][2], 100, 1e-3);
}

TEST(Fuse, ColorsOfOtherDrivesThatAreTooBrightAreNotUsed) {
  const cv::Mat3b truth(60, 80, cv::Vec3b::all(200)), dark(60, 80, cv::Vec3b::all(100));
  Still still({truth, dark}, truth);
  still.scene.views[1].gain = {1.5, 1.5, 1.5};
  still.scene.views[2].gain = {2, 2, 2};
  EXPECT_EQ(still.run().color[0], cv::Vec3f(300, 300, 300)) << "within one drive, the blending corrects it";
  still.scene.views[1].sequence = still.scene.views[1].drive = 1;
  const Fused out = still.run();
  EXPECT_EQ(out.candidates.leading[0].view, 2);
  EXPECT_EQ(out.color[0], cv::Vec3f(200, 200, 200));
  Still alone({truth}, truth);
  alone.scene.views[1].gain = {1.5, 1.5, 1.5};
  alone.scene.views[1].sequence = alone.scene.views[1].drive = 1;
  EXPECT_FALSE(alone.run().candidates.leading[0].found());
}

TEST(Fuse, ColorsAdjacentToTheSkyOfAnotherDriveAreNotUsed) {
  cv::Mat3b roof(60, 80, cv::Vec3b::all(80));
  roof.rowRange(0, 30) = cv::Scalar::all(200);
  Still still({roof}, roof);
  still.scene.views[1].gain = {1.5, 1.5, 1.5};
  still.scene.views[1].sequence = still.scene.views[1].drive = 1;
  const Fused out = still.run();
  for (std::size_t i = 0; i < out.color.size(); ++i) {
    const cv::Point p = out.candidates.hole.pixels[i];
    EXPECT_EQ(out.candidates.leading[i].found(), p.y > 30);
    EXPECT_EQ(out.sky(p) != 0, p.y <= 30);
  }
}

TEST(Fuse, FootprintsDoNotOverlapTheMask) {
  const cv::Mat3b truth = waves(80, 60, 1);
  Still still({truth}, truth);
  still.scene.masks[1](cv::Rect(0, 0, 30, 60)) = 255;  // next to the hole, so that footprints would overlap it
  for (sample::Candidate& c : still.candidates.leading) c.footprint = {3, 3};
  for (const Fused out = still.run(); const sample::Candidate& c : out.candidates.leading)
    EXPECT_EQ(c.footprint, c.position.x == 30 ? cv::Vec2b(1, 1) : cv::Vec2b(3, 3));
}

}  // namespace
}  // namespace dvi::harmonize
