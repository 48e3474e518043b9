#include "dvi/regularize/regularize.h"

#include <cstddef>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/core/random.h"
#include "dvi/depth/depth_map.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/region.h"
#include "dvi/regularize/labeling.h"
#include "dvi/sample/candidates.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::regularize {
namespace {

const RegularizeOptions kOn{true};

cv::Mat1b disc(int width, int height, cv::Point center, int radius) {
  cv::Mat1b mask(height, width, uchar{0});
  cv::circle(mask, center, radius, 255, cv::FILLED);
  return mask;
}

/// Candidates in view 1 for all hole pixels, at their true positions plus an error.
sample::Candidates candidates_in_one(const cv::Mat1b& mask, int disparity, cv::Point2f error = {}) {
  sample::Candidates out{Region(mask), {}};
  for (const cv::Point p : out.hole.pixels) out.leading.push_back({1, cv::Point2f(p + cv::Point(disparity, 0)) + error});
  return out;
}

depth::DepthMap flat_depth(const FlatScene& scene) { return {scene.depth(), cv::Mat1f(scene.height, scene.width, 0.01F)}; }

double correct_share(const sample::Candidates& found, const sample::Candidates& truth) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < truth.leading.size(); ++i) right += found.leading[i].position == truth.leading[i].position;
  return static_cast<double>(right) / static_cast<double>(truth.leading.size());
}

struct Street {
  cv::Mat3b truth = waves(90, 70, 7);
  cv::Mat1b hole = disc(90, 70, {40, 35}, 14);
  FlatScene scene{truth, hole};
  Street() {
    scene.images[0].setTo(cv::Scalar(255, 0, 255), hole);
    scene.add_source(8, truth);
    scene.add_source(-5, truth);
  }
  Labeling run(const sample::Candidates& candidates, const RegularizeOptions& options = kOn) const {
    return regularize(candidates, {scene.lazy(), 0, flat_depth(scene), {}}, options);
  }
};

TEST(Regularize, DoesNotChangeExactCandidates) {
  const Street street;
  const sample::Candidates exact = candidates_in_one(street.hole, 8);
  const Labeling out = street.run(exact);
  EXPECT_EQ(correct_share(out.candidates, exact), 1);
  EXPECT_EQ(out.energy->before, out.energy->after);
}

TEST(Regularize, RecoversAUniformShift) {
  const Street street;
  const Labeling out = street.run(candidates_in_one(street.hole, 8, {1, -2}));
  EXPECT_GT(correct_share(out.candidates, candidates_in_one(street.hole, 8)), 0.99);
  EXPECT_LT(out.energy->after, 0.7 * out.energy->before);
}

TEST(Regularize, RecoversAShiftOfOneOfTwoSources) {
  const Street street;
  sample::Candidates truth = candidates_in_one(street.hole, 8), wrong = truth;
  for (std::size_t i = 0; i < truth.leading.size(); ++i) {
    const cv::Point p = truth.hole.pixels[i];
    if (p.x <= 40) continue;
    truth.leading[i] = {2, cv::Point2f(p + cv::Point(-5, 0))};
    wrong.leading[i] = {2, truth.leading[i].position + cv::Point2f(-1, 1)};
  }
  EXPECT_GT(correct_share(street.run(wrong).candidates, truth), 0.97);
}

TEST(Regularize, WarpsNeighborsByTheirOwnDepth) {
  Street street;
  // The right half is at half the depth, so that its parallax in the source is twice as large.
  depth::DepthMap depth = flat_depth(street.scene);
  cv::Mat3b source(street.truth.size());
  sample::Candidates exact{Region(street.hole), {}};
  for (const int near : {0, 1})
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 90; ++x) {
        if (near != (x >= 40)) continue;
        if (near != 0) depth.z(y, x) = static_cast<float>(FlatScene::kDepthM) / 2;
        const int to = x + (near != 0 ? 16 : 8);
        if (to < 90) source(y, to) = street.truth(y, x);
      }
  for (const cv::Point p : exact.hole.pixels) exact.leading.push_back({1, cv::Point2f(p + cv::Point(p.x >= 40 ? 16 : 8, 0))});
  street.scene.images[1] = source;
  const Labeling out = regularize(exact, {street.scene.lazy(), 0, depth, {}}, kOn);
  EXPECT_EQ(correct_share(out.candidates, exact), 1);
  RegularizeOptions no_inner_cost = kOn;
  no_inner_cost.alpha = 0;
  EXPECT_EQ(street.scene.images.size(), 3);
  EXPECT_EQ(regularize(exact, {street.scene.lazy(), 0, depth, {}}, no_inner_cost).energy->before, 0);
}

TEST(Regularize, NeverShiftsIntoTheSourcesMaskOrOutOfItsImage) {
  Street street;
  street.scene.masks[1](cv::Rect(50, 0, 40, 35)) = 255;
  sample::Candidates shifted = candidates_in_one(street.hole, 8, {2, 2});
  for (auto& c : shifted.leading) c.position.x += 30;  // up to the image's right border
  const Labeling out = street.run(shifted);
  for (std::size_t i = 0; i < shifted.leading.size(); ++i) {
    const cv::Point2f from = shifted.leading[i].position, to = out.candidates.leading[i].position;
    if (from == to) continue;
    ASSERT_LE(to.x, 89);
    ASSERT_EQ(street.scene.masks[1](cv::Point(to)), 0);
  }
}

TEST(Regularize, AShiftedPixelHasItsLeadingSourceOnly) {
  const Street street;
  sample::Candidates shifted = candidates_in_one(street.hole, 8, {1, 1});
  shifted.extra_per_pixel = 1;
  for (const sample::Candidate& c : shifted.leading) shifted.extra.push_back({2, c.position});
  const sample::Candidates out = street.run(shifted).candidates;
  int shifted_pixels = 0;
  for (std::size_t i = 0; i < out.leading.size(); ++i) {
    const bool stayed = out.leading[i].position == shifted.leading[i].position;
    EXPECT_EQ(out.others(i)[0].found(), stayed);
    shifted_pixels += stayed ? 0 : 1;
  }
  EXPECT_GT(shifted_pixels, 0);
}

TEST(Regularize, IgnoresPixelsWithoutCandidates) {
  const Street street;
  sample::Candidates some = candidates_in_one(street.hole, 8, {1, 1}), none = some;
  for (std::size_t i = 0; i < some.leading.size(); i += 3) some.leading[i] = {};
  for (auto& c : none.leading) c = {};
  const Labeling out = street.run(some);
  for (std::size_t i = 0; i < some.leading.size(); i += 3) EXPECT_FALSE(out.candidates.leading[i].found());
  EXPECT_EQ(street.run(none).energy->before, 0);
}

TEST(Regularize, ChangesNothingIfDisabledOrWithAWindowOfOnePixel) {
  const Street street;
  const sample::Candidates shifted = candidates_in_one(street.hole, 8, {1, -2});
  RegularizeOptions off = kOn, one = kOn;
  off.enabled = false;
  one.window = 1;
  for (const RegularizeOptions& options : {off, one}) {
    const Labeling out = street.run(shifted, options);
    EXPECT_EQ(correct_share(out.candidates, shifted), 1);
    EXPECT_EQ(out.energy.has_value(), options.enabled);
  }
  const Labeling alone = street.run(shifted, one);
  EXPECT_EQ(alone.energy->after, alone.energy->before);
  EXPECT_EQ(alone.energy->before, street.run(shifted).energy->before);
  one.window = 4;
  EXPECT_THROW(street.run(shifted, one), UsageError);
}

TEST(Regularize, HandlesEmptyWholeAndSeparateHoles) {
  const cv::Mat3b picture = waves(24, 16, 3);
  cv::Mat1b empty(16, 24, uchar{0}), whole(16, 24, uchar{255}), corners = empty.clone();
  corners(cv::Rect(0, 0, 5, 4)) = 255;
  corners(cv::Rect(20, 11, 4, 5)) = 255;
  for (const cv::Mat1b& mask : {empty, whole, corners}) {
    FlatScene scene(picture, mask);
    scene.add_source(0, picture);
    const sample::Candidates exact = candidates_in_one(mask, 0);
    const Labeling out = regularize(exact, {scene.lazy(), 0, flat_depth(scene), {}}, kOn);
    EXPECT_TRUE(exact.leading.empty() || correct_share(out.candidates, exact) == 1);
    EXPECT_LE(out.energy->after, out.energy->before);
  }
}

TEST(Regularize, HandlesUnknownDepthAndSky) {
  const Street street;
  depth::DepthMap depth = flat_depth(street.scene);
  depth.z(cv::Rect(0, 0, 40, 70)) = depth::DepthMap::kUnknown;
  const Labeling out = regularize(candidates_in_one(street.hole, 8, {1, 0}), {street.scene.lazy(), 0, depth, {}}, kOn);
  EXPECT_GT(correct_share(out.candidates, candidates_in_one(street.hole, 8)), 0.99);
  depth.z = depth::DepthMap::kSky;
  EXPECT_LE(regularize(candidates_in_one(street.hole, 0), {street.scene.lazy(), 0, depth, {}}, kOn).energy->after, 1e9);
}

TEST(Regularize, IsDeterministic) {
  const Street street;
  sample::Candidates noisy = candidates_in_one(street.hole, 8);
  Random random(5);
  for (auto& c : noisy.leading) c.position += quantize(random.uniform(-2, 2), random.uniform(-2, 2));
  const Labeling a = street.run(noisy), b = street.run(noisy);
  EXPECT_EQ(correct_share(a.candidates, b.candidates), 1);
  EXPECT_EQ(a.energy->after, b.energy->after);
  EXPECT_LT(a.energy->after, a.energy->before);
}

}  // namespace
}  // namespace dvi::regularize
