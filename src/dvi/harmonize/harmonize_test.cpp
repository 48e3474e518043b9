#include "dvi/harmonize/harmonize.h"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/vignetting.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/image/region.h"
#include "dvi/sample/candidates.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::harmonize {
namespace {

constexpr int kWidth = 80, kHeight = 60;

cv::Mat1b rectangle(cv::Rect hole) {
  cv::Mat1b mask(kHeight, kWidth, uchar{0});
  mask(hole) = 255;
  return mask;
}

cv::Mat3b ramp() {
  cv::Mat3b out(kHeight, kWidth);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      out(y, x) = cv::Vec3b(cv::saturate_cast<uchar>(2 * x + y), cv::saturate_cast<uchar>(3 * y), 77);
  return out;
}

cv::Mat3b brighter(const cv::Mat3b& image, int levels) {
  cv::Mat3b out;
  cv::add(image, cv::Scalar::all(levels), out);
  return out;
}

/// A target with a magenta hole, and its truth.
struct Case {
  cv::Mat3b truth;
  cv::Mat1b hole;
  FlatScene scene;
  sample::Candidates candidates;

  Case(const cv::Mat3b& picture, const cv::Mat1b& mask) : truth(picture), hole(mask), scene(picture, mask) {
    scene.images[0].setTo(cv::Scalar(255, 0, 255), hole);
    candidates = {Region(hole), std::vector<sample::Candidate>(Region(hole).size())};
  }
  /// Makes `view` the source of the hole's pixels within `where`.
  void copy_from(int view, int disparity, cv::Rect where = {0, 0, kWidth, kHeight}) {
    for (std::size_t i = 0; i < candidates.leading.size(); ++i)
      if (const cv::Point p = candidates.hole.pixels[i]; where.contains(p))
        candidates.leading[i] = {view, cv::Point2f(p + cv::Point(disparity, 0))};
  }
  FilledFrame run(const HarmonizeOptions& options = {}) const {
    const depth::DepthMap depth{scene.depth(), cv::Mat1f(kHeight, kWidth, 0.1F)};
    return harmonize({scene.lazy(), 0, depth, {}}, candidates, {}, options);
  }
  double max_error(const FilledFrame& out) const {
    cv::Mat3f expected;
    truth.convertTo(expected, CV_32FC3);
    return cv::norm(out.color, expected, cv::NORM_INF);
  }
};

TEST(Harmonize, DifferencesAtTheBoundaryFadeInCopiesOfOtherDrives) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b::all(100)), rectangle({5, 5, 70, 50}));
  c.scene.add_source(0, c.truth, 1);
  c.copy_from(1, 0);
  c.scene.images[0].setTo(cv::Scalar::all(160), ~c.hole);  // all known pixels have another illumination, or have changed
  const FilledFrame out = c.run();
  EXPECT_GT(out.color(5, 40)[0], 130);
  EXPECT_NEAR(out.color(30, 40)[0], 100, 15);
  c.scene.views[1].sequence = c.scene.views[1].drive = 0;
  EXPECT_NEAR(c.run().color(30, 40)[0], 160, 0.5);
}

TEST(Harmonize, AnInconsistentBoundaryFadesInCopies) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b::all(100)), rectangle({5, 5, 70, 50}));
  c.scene.add_source(0, c.truth);
  c.copy_from(1, 0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (c.hole(y, x) == 0 && (x + y) / 8 % 2 == 0) c.scene.images[0](y, x) = cv::Vec3b::all(250);
  EXPECT_NEAR(c.run().color(30, 40)[0], 100, 25);
  HarmonizeOptions published;
  published.robust_boundary = false;
  EXPECT_NEAR(c.run(published).color(30, 40)[0], 175, 15);
}

TEST(Harmonize, CopiesAreCorrectedForVignetting) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b::all(200)), rectangle({5, 10, 30, 40}));
  c.scene.add_source(40, c.truth);
  for (std::size_t i = 0; i < 2; ++i) {
    c.scene.views[i].vignetting = 0.9F;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) c.scene.images[i](y, x) *= vignetting(c.scene.views[i], cv::Point(x, y));
  }
  c.scene.images[0].setTo(cv::Scalar(255, 0, 255), c.hole);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      c.truth(y, x) = cv::Vec3b::all(cv::saturate_cast<uchar>(200 * vignetting(c.scene.views[0], cv::Point(x, y))));
  c.copy_from(1, 40);
  HarmonizeOptions copies;
  copies.poisson = false;
  EXPECT_LT(c.max_error(c.run(copies)), 2);
  EXPECT_LT(c.max_error(c.run()), 2);
}

TEST(Harmonize, SaturatedColorsAreNotCorrectedForVignetting) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b::all(255)), rectangle({5, 10, 30, 40}));
  c.scene.add_source(40, c.truth);
  for (std::size_t i = 0; i < 2; ++i) c.scene.views[i].vignetting = 0.9F;
  c.copy_from(1, 40);
  EXPECT_LT(c.max_error(c.run()), 0.1);
}

TEST(Harmonize, RemovesAConstantOffsetOfTheSource) {
  for (const cv::Rect hole : {cv::Rect(25, 20, 30, 20), cv::Rect(0, 0, 20, 20), cv::Rect(10, 40, 40, 20)}) {
    Case c(waves(kWidth, kHeight, 4), rectangle(hole));
    c.scene.add_source(10, brighter(c.truth, 25));
    c.copy_from(1, 10);
    EXPECT_LT(c.max_error(c.run()), 0.1);
  }
}

TEST(Harmonize, UnobservedPixelsContinueALinearRamp) {
  Case c(ramp(), rectangle({20, 15, 40, 30}));
  c.candidates.leading[0] = {};
  EXPECT_LT(c.max_error(c.run()), 0.1);
}

TEST(Harmonize, UnobservedSkyAndSurfacesDoNotMix) {
  cv::Mat3b picture(kHeight, kWidth, cv::Vec3b::all(200));
  picture.rowRange(30, kHeight) = cv::Scalar::all(60);
  Case c(picture, rectangle({0, 15, kWidth, 30}));
  c.scene.add_source(0, c.truth);
  c.copy_from(1, 0, {0, 30, kWidth, 15});
  depth::DepthMap depth{c.scene.depth(), cv::Mat1f(kHeight, kWidth, 0.1F)};
  EXPECT_LT(harmonize({c.scene.lazy(), 0, depth, {}}, c.candidates, {}, {}).color(29, 40)[0], 100)
      << "without sky, colors continue";
  depth.z.rowRange(0, 30) = depth::DepthMap::kInfinity;
  EXPECT_LT(c.max_error(harmonize({c.scene.lazy(), 0, depth, {}}, c.candidates, {}, {})), 3);
}

TEST(Harmonize, SkyOfAnotherDriveIsAtInfinity) {
  cv::Mat3b roof(kHeight, kWidth, cv::Vec3b::all(80));
  roof.rowRange(0, 30).setTo(200);
  Case c(roof, rectangle({20, 15, 40, 30}));
  c.scene.add_source(0, roof, 1);
  c.scene.views[1].gain = {1.5, 1.5, 1.5};  // the sky would be brighter than white
  c.copy_from(1, 0);
  const FilledFrame out = c.run();
  EXPECT_EQ(out.depth(20, 40), depth::DepthMap::kInfinity);
  EXPECT_EQ(out.depth(40, 40), c.scene.depth()(40, 40));
  EXPECT_EQ(out.depth(10, 40), c.scene.depth()(10, 40)) << "outside the hole";
}

TEST(Harmonize, UnobservedSkyBetweenBuildingsContinuesTheSkyAboveThem) {
  cv::Mat3b picture(kHeight, kWidth, cv::Vec3b::all(200));
  for (const int x : {0, 70}) picture(cv::Rect(x, 25, 10, 35)).setTo(60);
  picture.rowRange(40, kHeight).setTo(60);
  Case c(picture, rectangle({10, 10, 60, 40}));
  depth::DepthMap depth{c.scene.depth(), cv::Mat1f(kHeight, kWidth, 0.1F)};
  depth.z.setTo(depth::DepthMap::kSky);  // including buildings above the uppermost beam of the LiDAR
  depth.z(cv::Rect(10, 10, 60, 30)) = depth::DepthMap::kInfinity;
  depth.z.rowRange(40, kHeight) = 30.0F;  // unobserved, too
  const FilledFrame out = harmonize({c.scene.lazy(), 0, depth, {}}, c.candidates, {}, {});
  EXPECT_NEAR(out.color(38, 40)[0], 200, 10);
  EXPECT_NEAR(out.color(42, 40)[0], 60, 10) << "surfaces in front of the sky do not have its color";
  EXPECT_EQ(cv::countNonZero(out.kind == static_cast<uchar>(Kind::empty)), 0);
}

TEST(Harmonize, UnobservedGroundAndUprightSurfacesDoNotMix) {
  cv::Mat3b picture(kHeight, kWidth, cv::Vec3b::all(60));
  picture.rowRange(30, kHeight) = cv::Scalar::all(200);
  picture.colRange(70, kWidth).setTo(60);  // an object at the right, in front of the ground
  Case c(picture, rectangle({20, 15, 50, 30}));
  cv::Mat1b classes(kHeight, kWidth, static_cast<uchar>(SurfaceClass::upright));
  classes(cv::Rect(0, 30, 70, 30)).setTo(static_cast<uchar>(SurfaceClass::ground));
  const depth::DepthMap depth{c.scene.depth(), cv::Mat1f(kHeight, kWidth, 0.1F)};
  EXPECT_LT(c.max_error(harmonize({c.scene.lazy(), 0, depth, {}}, c.candidates, {.classes = classes}, {})), 10);
  EXPECT_GT(c.max_error(harmonize({c.scene.lazy(), 0, depth, {}}, c.candidates, {}, {})), 40) << "without classes they mix";
}

TEST(Harmonize, UnobservedPixelsContinueHorizontalLayers) {
  cv::Mat3b layers(kHeight, kWidth, cv::Vec3b(200, 200, 200));
  layers.rowRange(30, kHeight) = cv::Scalar(60, 60, 60);
  Case c(layers, rectangle({30, 15, 12, 30}));
  c.candidates.leading[0] = {};
  HarmonizeOptions membrane;
  membrane.unobserved_vertical = 1;
  EXPECT_LT(c.max_error(c.run()), 0.8 * c.max_error(c.run(membrane)));
}

TEST(Harmonize, ReducesALinearOffsetOfTheSource) {
  Case c(waves(kWidth, kHeight, 4), rectangle({20, 15, 40, 30}));
  cv::Mat3b tinted = c.truth.clone();
  for (int x = 0; x < kWidth; ++x) tinted.col(x) += cv::Scalar::all(0.125 * x);
  c.scene.add_source(0, tinted);
  c.copy_from(1, 0);
  HarmonizeOptions plain;
  plain.poisson = false;
  EXPECT_LT(c.max_error(c.run()), 0.6 * c.max_error(c.run(plain)));
}

TEST(Harmonize, BlendsTwoSourcesWithoutASeam) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b(90, 100, 110)), rectangle({20, 15, 40, 30}));
  c.scene.add_source(10, brighter(c.truth, 30));
  c.scene.add_source(-10, brighter(c.truth, -30));
  c.copy_from(1, 10, {0, 0, 40, kHeight});
  c.copy_from(2, -10, {40, 0, 40, kHeight});
  EXPECT_LT(c.max_error(c.run()), 0.1);
  HarmonizeOptions plain;
  plain.poisson = false;
  EXPECT_NEAR(c.max_error(c.run(plain)), 30, 1e-3);
}

TEST(Harmonize, ADisplacedEdgeAtASeamDoesNotBrightenDarkPixels) {
  cv::Mat3b picture(kHeight, kWidth, cv::Vec3b::all(230));
  const cv::Rect bin(32, 24, 16, 16);
  picture(bin).setTo(50);
  Case c(picture, rectangle({10, 10, 60, 40}));
  c.scene.add_source(0, c.truth);
  c.scene.add_source(0, cv::Mat3b(kHeight, kWidth, cv::Vec3b::all(230)));  // the bin is at another position in this source
  c.copy_from(2, 0);
  c.copy_from(1, 0, bin);
  EXPECT_NEAR(c.run().color(32, 40)[0], 50, 30) << "not halfway to the color of the wall";
}

TEST(Harmonize, ContradictorySourcesAreNotAveragedAtASeam) {
  const auto wall_until = [](int x) {
    cv::Mat3b out(kHeight, kWidth, cv::Vec3b::all(40));
    out.colRange(0, x).setTo(cv::Scalar::all(230));
    return out;
  };
  Case c(wall_until(40), rectangle({10, 10, 60, 40}));
  c.scene.add_source(0, wall_until(48));
  c.scene.add_source(0, wall_until(32));
  c.copy_from(1, 0, {0, 0, 40, kHeight});
  c.copy_from(2, 0, {40, 0, 40, kHeight});
  const FilledFrame out = c.run();
  EXPECT_NEAR(out.color(30, 36)[0], 230, 15) << "the steps of both sources agree at the seam, their colors do not";
  EXPECT_NEAR(out.color(30, 44)[0], 40, 15);
}

TEST(Harmonize, DoesNotChangePixelsOutsideTheHole) {
  Case c(waves(kWidth, kHeight, 4), rectangle({25, 20, 30, 20}));
  c.scene.add_source(3, brighter(c.truth, 20));
  c.copy_from(1, 3, {0, 0, 40, kHeight});
  const FilledFrame out = c.run();
  cv::Mat3f input;
  c.scene.images[0].convertTo(input, CV_32FC3);
  cv::Mat1b outside;
  cv::bitwise_not(c.hole, outside);
  EXPECT_EQ(cv::norm(out.color, input, cv::NORM_INF, outside), 0);
  EXPECT_EQ(cv::norm(out.kind, cv::NORM_INF, outside), 0);
  EXPECT_EQ(cv::norm(out.provenance, cv::NORM_INF, outside), 0);
  EXPECT_EQ(cv::countNonZero((out.confidence != 255) & outside), 0);
  EXPECT_EQ(cv::norm(out.mask, c.hole, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(out.depth, c.scene.depth(), cv::NORM_INF), 0);
}

TEST(Harmonize, WritesTheProvenanceOfEachPixel) {
  Case c(waves(kWidth, kHeight, 4), rectangle({20, 15, 40, 30}));
  c.scene.add_source(10, c.truth);
  c.scene.add_source(-10, c.truth, 1);
  c.copy_from(1, 10, {20, 15, 10, 30});
  c.copy_from(2, -10, {30, 15, 10, 30});
  for (sample::Candidate& candidate : c.candidates.leading)
    if (candidate.view == 1) candidate.position += cv::Point2f(0.0625F, 0.5F);
  const FilledFrame out = c.run();
  const auto kind = [&](int x, int y) { return static_cast<Kind>(out.kind(y, x)); };
  EXPECT_EQ(kind(25, 20), Kind::copied);
  EXPECT_EQ(kind(35, 20), Kind::copied_elsewhere);
  EXPECT_EQ(kind(50, 20), Kind::interpolated);
  EXPECT_EQ(out.provenance(20, 25), cv::Vec3w(2, 35 * 16 + 1, 20 * 16 + 8));
  EXPECT_EQ(out.provenance(20, 35), cv::Vec3w(3, 25 * 16, 20 * 16));
  EXPECT_EQ(out.provenance(20, 50), cv::Vec3w());
  EXPECT_EQ(out.used(20, 25), cv::Vec3b(1, 1, 1));
  EXPECT_EQ(out.used(20, 50), cv::Vec3b());
  EXPECT_GT(out.confidence(20, 35), out.confidence(20, 50));
  EXPECT_GT(out.confidence(20, 41), out.confidence(30, 50));
  EXPECT_GT(out.confidence(30, 50), 0);
}

TEST(Harmonize, WithoutPoissonCopiesAreUnchangedAndUnobservedPixelsContinueThem) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b(90, 100, 110)), rectangle({20, 15, 40, 30}));
  c.scene.add_source(0, brighter(c.truth, 30));
  c.copy_from(1, 0, {20, 15, 20, 30});
  HarmonizeOptions plain;
  plain.poisson = false;
  const FilledFrame out = c.run(plain);
  EXPECT_EQ(out.color(20, 25), cv::Vec3f(120, 130, 140));
  EXPECT_GT(out.color(30, 41)[0], 110);
  EXPECT_LT(out.color(30, 58)[0], 100);
  EXPECT_EQ(out.kind(30, 58), static_cast<uchar>(Kind::interpolated));
}

TEST(Harmonize, UnobservedPixelsThatAreLeftAreBlackAndDoNotAffectOthers) {
  Case c(waves(kWidth, kHeight, 4), rectangle({20, 15, 40, 30}));
  c.scene.add_source(10, brighter(c.truth, 25));
  c.copy_from(1, 10, {20, 15, 20, 30});
  HarmonizeOptions options;
  options.unobserved = Unobserved::leave;
  const FilledFrame out = c.run(options);
  cv::Mat3f truth;
  c.truth.convertTo(truth, CV_32FC3);
  const cv::Rect left(20, 15, 20, 30), right(40, 15, 20, 30);
  EXPECT_LT(cv::norm(out.color(left), truth(left), cv::NORM_INF), 0.1);
  EXPECT_EQ(cv::norm(out.color(right), cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(out.kind(right) != static_cast<uchar>(Kind::empty)), 0);
  EXPECT_EQ(cv::norm(out.confidence(right), cv::NORM_INF), 0);
}

TEST(Harmonize, AHoleOfTheWholeFrameHasTheMeanOfItsCopies) {
  Case c(waves(kWidth, kHeight, 4), rectangle({0, 0, kWidth, kHeight}));
  c.scene.add_source(0, c.truth);
  c.copy_from(1, 0);
  EXPECT_LT(c.max_error(c.run()), 0.2);
  for (std::size_t i = 0; i < c.candidates.leading.size(); i += 2) c.candidates.leading[i] = {};
  const FilledFrame half = c.run();
  EXPECT_NEAR(cv::mean(half.color)[0], cv::mean(c.truth)[0], 5);
}

TEST(Harmonize, AnUnobservedHoleOfTheWholeFrameIsEmpty) {
  const Case c(waves(kWidth, kHeight, 4), rectangle({0, 0, kWidth, kHeight}));
  const FilledFrame out = c.run();
  EXPECT_EQ(cv::norm(out.color, cv::NORM_INF), 0);
  EXPECT_EQ(cv::countNonZero(out.kind != static_cast<uchar>(Kind::empty)), 0);
}

TEST(Harmonize, ReturnsTheInputForAnEmptyHole) {
  const Case c(waves(kWidth, kHeight, 4), cv::Mat1b(kHeight, kWidth, uchar{0}));
  EXPECT_EQ(c.max_error(c.run()), 0);
}

TEST(Harmonize, MaskedPixelsOfTheSourceDoNotBleedIntoTheHole) {
  Case c(waves(kWidth, kHeight, 4), rectangle({20, 15, 40, 30}));
  c.scene.add_source(0, c.truth);
  c.scene.images[1](cv::Rect(5, 25, 15, 10)) = cv::Vec3b(255, 255, 255);
  c.scene.masks[1](cv::Rect(5, 25, 15, 10)) = 255;
  c.copy_from(1, 0);
  EXPECT_LT(c.max_error(c.run()), 30);
}

TEST(Harmonize, ColorsAreWithinRange) {
  Case c(cv::Mat3b(kHeight, kWidth, cv::Vec3b(250, 250, 250)), rectangle({20, 15, 40, 30}));
  c.scene.add_source(0, waves(kWidth, kHeight, 9));
  c.copy_from(1, 0);
  const FilledFrame out = c.run();
  double least = 0, most = 0;
  cv::minMaxLoc(out.color.reshape(1), &least, &most);
  EXPECT_GE(least, 0);
  EXPECT_LE(most, 255);
}

TEST(Harmonize, ConfidenceIsCalibratedByKnownPixels) {
  Case c(ramp(), rectangle({30, 20, 20, 20}));
  c.scene.add_source(2, c.truth);
  c.copy_from(1, 2);
  cv::Mat1b surroundings = rectangle({10, 5, 60, 50});
  surroundings(cv::Rect(26, 16, 28, 28)) = 0;
  sample::Candidates known{Region(surroundings), std::vector<sample::Candidate>(Region(surroundings).size())};
  const depth::DepthMap depth{c.scene.depth(), cv::Mat1f(kHeight, kWidth, 0.1F)};
  const auto mean_confidence = [&](int off_px) {
    for (std::size_t i = 0; i < known.leading.size(); ++i)
      known.leading[i] = {1, cv::Point2f(known.hole.pixels[i] + cv::Point(2 + (i % 2 == 0 ? off_px : -off_px), 0))};
    return cv::mean(harmonize({c.scene.lazy(), 0, depth, {}}, c.candidates, {.known = known}, {}).confidence, c.hole)[0];
  };
  EXPECT_GT(mean_confidence(0), mean_confidence(8) + 5) << "wrong copies of known pixels reduce it";
}

TEST(Harmonize, IsDeterministic) {
  Case c(waves(kWidth, kHeight, 4), rectangle({20, 15, 40, 30}));
  c.scene.add_source(10, waves(kWidth, kHeight, 5));
  c.copy_from(1, 10, {20, 15, 25, 30});
  const FilledFrame a = c.run(), b = c.run();
  EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.confidence, b.confidence, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::harmonize
