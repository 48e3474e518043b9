#include "dvi/depth/plane_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/depth/semi_global.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::depth {
namespace {

const cv::Rect kHole(35, 15, 24, 20);

cv::Mat1b mask_of(const cv::Rect& hole) {
  cv::Mat1b mask(64, 96, uchar{0});
  mask(hole) = 255;
  return mask;
}

/// Sky all over, but for a surface 5 m before the camera at the bottom.
depth::DepthMap no_returns() {
  depth::DepthMap depth{cv::Mat1f(64, 96, depth::DepthMap::kSky), cv::Mat1f(64, 96, 0.0F)};
  depth.z.rowRange(58, 64) = 5.0F;
  return depth;
}

Lazy<depth::VisibilityMap> visibility(const FlatScene& scene) {
  return {scene.views.size(), scene.views.size(), [masks = scene.masks](std::size_t i) {
            const depth::DepthMap unknown{cv::Mat1f(masks[i].size(), depth::DepthMap::kUnknown),
                                          cv::Mat1f(masks[i].size(), 0.0F)};
            return depth::visibility_map(unknown, masks[i]);
          }};
}

depth::DepthMap swept(const FlatScene& scene, const depth::DepthMap& depth = no_returns()) {
  return plane_sweep({scene.lazy(), 0, depth, visibility(scene)}, {});
}

/// A wall 10 m away, where the LiDAR has no return.
FlatScene wall(const cv::Mat3b& picture, const std::vector<int>& disparities = {-6, -3, 3, 6}) {
  FlatScene scene(picture, mask_of(kHole));
  for (const int d : disparities) scene.add_source(d, picture);
  return scene;
}

/// What does not move although the cameras do.
FlatScene far_away(const cv::Mat3b& picture) {
  FlatScene scene(picture, mask_of(kHole));
  for (const int d : {-6, -3, 3, 6}) {
    scene.add_source(d, picture);
    scene.images.back() = picture;
  }
  return scene;
}

double part(const depth::DepthMap& depth, const std::function<bool(float)>& is) {
  int count = 0;
  for (int y = kHole.y; y < kHole.br().y; ++y)
    for (int x = kHole.x; x < kHole.br().x; ++x) count += is(depth.z(y, x)) ? 1 : 0;
  return count / static_cast<double>(kHole.area());
}

bool at_wall(float z) { return std::abs(z / FlatScene::kDepthM - 1) < 0.03; }
bool at_infinity(float z) { return z == depth::DepthMap::kInfinity; }
bool kept(float z) { return z == depth::DepthMap::kSky; }

/// Most of it is found, and nothing wrong: spots that are too plain are left out.
void expect_wall(const depth::DepthMap& depth, double least) {
  EXPECT_GT(part(depth, at_wall), least);
  EXPECT_GT(part(depth, [](float z) { return at_wall(z) || kept(z); }), 0.98);
}

TEST(PlaneSweep, FindsAWallWithoutReturns) {
  const depth::DepthMap out = swept(wall(waves(96, 64, 1)));
  expect_wall(out, 0.75);
  int beside = 0;
  const cv::Rect near(kHole.tl() - cv::Point(12, 12), kHole.br() + cv::Point(12, 12));
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 96; ++x) {
      const bool found = depth::DepthMap::is_surface(out.z(y, x));
      if (!near.contains({x, y})) {
        EXPECT_EQ(out.z(y, x), no_returns().z(y, x));
      } else if (found && no_returns().z(y, x) == depth::DepthMap::kSky) {
        EXPECT_GT(out.sigma(y, x), 0);
        beside += kHole.contains({x, y}) ? 0 : 1;
      }
    }
  EXPECT_GT(beside, 500) << "the target itself shows what is round the hole";
}

TEST(PlaneSweep, ASurfaceGoesOnUpwardsAsFarAsItsTexture) {
  cv::Mat3b picture = waves(96, 64, 1);
  picture.rowRange(0, 21) = cv::Scalar(230, 180, 150);  // the sky above the wall
  depth::DepthMap depth = no_returns();
  depth.z.rowRange(30, 58) = FlatScene::kDepthM;
  const depth::DepthMap out = swept(wall(picture, {-1, 1}), depth);  // too near to each other to tell its depth
  const auto walls = [&](int first, int last) {
    int count = 0;
    for (int y = first; y < last; ++y)
      for (int x = kHole.x; x < kHole.br().x; ++x) count += out.z(y, x) == static_cast<float>(FlatScene::kDepthM) ? 1 : 0;
    return count / static_cast<double>((last - first) * kHole.width);
  };
  EXPECT_GT(walls(24, 30), 0.75);
  EXPECT_LT(walls(kHole.y, 18), 0.1);
}

TEST(PlaneSweep, FindsItInAnotherLight) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.images[2] = 0.6 * scene.images[2];
  scene.images[3] = 1.15 * scene.images[3];
  expect_wall(swept(scene), 0.7);
}

TEST(PlaneSweep, GrayViewsTellDepthToo) {
  // Colored views from the target's place tell no depth; gray ones beside it do.
  FlatScene scene = wall(waves(96, 64, 1), {0, 0, -6, 6});
  for (const std::size_t i : {3U, 4U}) {
    cv::Mat1b gray;
    cv::cvtColor(scene.images[i], gray, cv::COLOR_BGR2GRAY);
    cv::cvtColor(gray, scene.images[i], cv::COLOR_GRAY2BGR);
    scene.views[i].gray = true;
  }
  expect_wall(swept(scene), 0.6);
}

TEST(PlaneSweep, OneWrongViewDoesNotMatter) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.images[2] = waves(96, 64, 9);
  expect_wall(swept(scene), 0.5);
}

TEST(PlaneSweep, WhatDoesNotMoveIsAtInfinity) { EXPECT_GT(part(swept(far_away(waves(96, 64, 2))), at_infinity), 0.98); }

TEST(PlaneSweep, PlainSkyIsAtInfinity) {
  EXPECT_EQ(part(swept(far_away(cv::Mat3b(64, 96, cv::Vec3b(230, 180, 150)))), at_infinity), 1);
}

TEST(PlaneSweep, PlainSkyThatNobodySawHasNoDepth) {
  FlatScene scene = far_away(cv::Mat3b(64, 96, cv::Vec3b(230, 180, 150)));
  for (cv::Mat1b& mask : scene.masks) mask = mask_of(kHole);  // only at a wrong, near depth is it outside the masks
  EXPECT_GT(part(swept(scene), kept), 0.9);
}

TEST(PlaneSweep, ViewsThatDisagreeFindNothing) {
  FlatScene scene = wall(waves(96, 64, 1));
  for (std::size_t i = 1; i < scene.images.size(); ++i) scene.images[i] = waves(96, 64, 10 + i);
  EXPECT_GT(part(swept(scene), kept), 0.9);
}

TEST(PlaneSweep, ReturnsAreKept) {
  depth::DepthMap depth = no_returns();
  depth.z(kHole) = 12.0F;
  const depth::DepthMap out = swept(wall(waves(96, 64, 1)), depth);
  EXPECT_EQ(cv::norm(out.z(kHole), depth.z(kHole), cv::NORM_INF), 0);
}

TEST(PlaneSweep, BelowTheLowestReturnNothingIsLookedFor) {
  depth::DepthMap depth = no_returns();
  depth.z.setTo(depth::DepthMap::kUnknown);
  EXPECT_EQ(part(swept(wall(waves(96, 64, 1)), depth), [](float z) { return z == depth::DepthMap::kUnknown; }), 1);
}

TEST(PlaneSweep, ACameraThatStandsSeesAllAsAtInfinity) {
  FlatScene scene = wall(waves(96, 64, 1), {0, 0});
  EXPECT_GT(part(swept(scene), at_infinity), 0.98) << "from there any depth shows the same";
  for (cv::Mat1b& mask : scene.masks) mask = mask_of(kHole);
  EXPECT_EQ(part(swept(scene), kept), 1);
}

TEST(PlaneSweep, MaskOverTheWholeFrame) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.masks[0].setTo(255);
  expect_wall(swept(scene), 0.7);
  for (cv::Mat1b& mask : scene.masks) mask.setTo(255);
  EXPECT_EQ(part(swept(scene), kept), 1);
}

TEST(PlaneSweep, NoOtherView) { EXPECT_EQ(part(swept(wall(waves(96, 64, 1), {})), kept), 1); }

TEST(PlaneSweep, NothingOverlaps) {
  FlatScene scene = wall(waves(96, 64, 1));
  for (std::size_t i = 1; i < scene.views.size(); ++i) scene.views[i].camera_from_world.R.diagonal() << -1, 1, -1;
  EXPECT_EQ(part(swept(scene), kept), 1) << "the others look backwards";
}

TEST(PlaneSweep, NoHole) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.masks[0].setTo(0);
  EXPECT_EQ(part(swept(scene), kept), 1);
}

int best(const cv::Mat& sum, int x) {
  const float* s = sum.ptr<float>(0, x);
  return static_cast<int>(std::min_element(s, s + sum.channels()) - s);
}

TEST(SemiGlobal, NeighborsOutvoteADoubtfulPixelButNotASureOne) {
  cv::Mat cost(1, 9, CV_32FC(4));
  for (int x = 0; x < 9; ++x)
    for (int k = 0; k < 4; ++k) cost.ptr<float>(0, x)[k] = k == (x == 4 ? 3 : 1) ? 0 : (x == 4 ? 0.1F : 2.0F);
  const cv::Mat1b all(1, 9, uchar{1});
  EXPECT_EQ(best(semi_global(cost, all, 0.1F, 1.0F), 4), 1);
  EXPECT_EQ(best(semi_global(cost, all, 0.01F, 0.02F), 4), 3);
  cv::Mat1b apart = all.clone();
  apart(0, 3) = apart(0, 5) = 0;
  EXPECT_EQ(best(semi_global(cost, apart, 0.1F, 1.0F), 4), 3) << "no path comes across what is no member";
}

}  // namespace
}  // namespace dvi::depth
