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

/// Sky, except a surface at 5 m in the lowest rows.
depth::DepthMap no_returns() {
  depth::DepthMap depth{cv::Mat1f(64, 96, depth::DepthMap::kSky), cv::Mat1f(64, 96, 0.0F)};
  depth.z.rowRange(58, 64) = 5.0F;
  return depth;
}

Lazy<depth::VisibilityMap> visibility(const FlatScene& scene) {
  return {scene.views.size(), scene.views.size(), [masks = scene.masks](std::size_t i) {
            const depth::DepthMap unknown{cv::Mat1f(masks[i].size(), depth::DepthMap::kUnknown),
                                          cv::Mat1f(masks[i].size(), 0.0F)};
            return depth::make_visibility_map(unknown, masks[i]);
          }};
}

depth::DepthMap run_plane_sweep(const FlatScene& scene, const depth::DepthMap& depth = no_returns()) {
  return sweep_planes({scene.lazy(), 0, depth, visibility(scene)}, {});
}

/// A wall at 10 m, where the LiDAR has no return.
FlatScene wall(const cv::Mat3b& picture, const std::vector<int>& disparities = {-6, -3, 3, 6}) {
  FlatScene scene(picture, mask_of(kHole));
  for (const int d : disparities) scene.add_source(d, picture);
  return scene;
}

/// A scene without parallax.
FlatScene distant_scene(const cv::Mat3b& picture) {
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

bool is_at_wall(float z) { return std::abs(z / FlatScene::kDepthM - 1) < 0.03; }
bool is_at_infinity(float z) { return z == depth::DepthMap::kInfinity; }
bool is_unchanged(float z) { return z == depth::DepthMap::kSky; }

/// Most pixels have the depth of the wall. The others, which have too little texture, are unchanged.
void expect_wall(const depth::DepthMap& depth, double min_part) {
  EXPECT_GT(part(depth, is_at_wall), min_part);
  EXPECT_GT(part(depth, [](float z) { return is_at_wall(z) || is_unchanged(z); }), 0.98);
}

TEST(PlaneSweep, FindsTheDepthOfAWallWithoutReturns) {
  const depth::DepthMap out = run_plane_sweep(wall(waves(96, 64, 1)));
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
  EXPECT_GT(beside, 500) << "the target itself shows the surroundings of the hole";
}

TEST(PlaneSweep, ASurfaceContinuesUpwardAsFarAsItsTexture) {
  cv::Mat3b picture = waves(96, 64, 1);
  picture.rowRange(0, 21) = cv::Scalar(230, 180, 150);  // the sky above the wall
  depth::DepthMap depth = no_returns();
  depth.z.rowRange(30, 58) = FlatScene::kDepthM;
  const depth::DepthMap out = run_plane_sweep(wall(picture, {-1, 1}), depth);  // too little parallax for a depth
  const auto walls = [&](int first, int last) {
    int count = 0;
    for (int y = first; y < last; ++y)
      for (int x = kHole.x; x < kHole.br().x; ++x) count += out.z(y, x) == static_cast<float>(FlatScene::kDepthM) ? 1 : 0;
    return count / static_cast<double>((last - first) * kHole.width);
  };
  EXPECT_GT(walls(24, 30), 0.75);
  EXPECT_LT(walls(kHole.y, 18), 0.1);
}

TEST(PlaneSweep, ToleratesChangesOfIllumination) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.images[2] = 0.6 * scene.images[2];
  scene.images[3] = 1.15 * scene.images[3];
  expect_wall(run_plane_sweep(scene), 0.7);
}

TEST(PlaneSweep, UsesGrayViewsToo) {
  // The colored views have no parallax to the target, only the gray ones do.
  FlatScene scene = wall(waves(96, 64, 1), {0, 0, -6, 6});
  for (const std::size_t i : {3U, 4U}) {
    cv::Mat1b gray;
    cv::cvtColor(scene.images[i], gray, cv::COLOR_BGR2GRAY);
    cv::cvtColor(gray, scene.images[i], cv::COLOR_GRAY2BGR);
    scene.views[i].gray = true;
  }
  expect_wall(run_plane_sweep(scene), 0.6);
}

TEST(PlaneSweep, ToleratesOneOutlier) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.images[2] = waves(96, 64, 9);
  expect_wall(run_plane_sweep(scene), 0.5);
}

TEST(PlaneSweep, TextureWithoutParallaxIsAtInfinity) {
  EXPECT_GT(part(run_plane_sweep(distant_scene(waves(96, 64, 2))), is_at_infinity), 0.98);
}

TEST(PlaneSweep, UniformSkyIsAtInfinity) {
  EXPECT_EQ(part(run_plane_sweep(distant_scene(cv::Mat3b(64, 96, cv::Vec3b(230, 180, 150)))), is_at_infinity), 1);
}

TEST(PlaneSweep, UnobservedUniformSkyHasNoDepth) {
  FlatScene scene = distant_scene(cv::Mat3b(64, 96, cv::Vec3b(230, 180, 150)));
  for (cv::Mat1b& mask : scene.masks) mask = mask_of(kHole);  // only at a wrong, near depth are pixels outside the masks
  EXPECT_GT(part(run_plane_sweep(scene), is_unchanged), 0.9);
}

TEST(PlaneSweep, ViewsThatDisagreeFindNothing) {
  FlatScene scene = wall(waves(96, 64, 1));
  for (std::size_t i = 1; i < scene.images.size(); ++i) scene.images[i] = waves(96, 64, 10 + i);
  EXPECT_GT(part(run_plane_sweep(scene), is_unchanged), 0.9);
}

TEST(PlaneSweep, PreservesKnownDepths) {
  depth::DepthMap depth = no_returns();
  depth.z(kHole) = 12.0F;
  const depth::DepthMap out = run_plane_sweep(wall(waves(96, 64, 1)), depth);
  EXPECT_EQ(cv::norm(out.z(kHole), depth.z(kHole), cv::NORM_INF), 0);
}

TEST(PlaneSweep, DoesNotSearchBelowTheLowestReturn) {
  depth::DepthMap depth = no_returns();
  depth.z.setTo(depth::DepthMap::kUnknown);
  EXPECT_EQ(part(run_plane_sweep(wall(waves(96, 64, 1)), depth), [](float z) { return z == depth::DepthMap::kUnknown; }), 1);
}

TEST(PlaneSweep, AStationaryCameraPlacesAllPixelsAtInfinity) {
  FlatScene scene = wall(waves(96, 64, 1), {0, 0});
  EXPECT_GT(part(run_plane_sweep(scene), is_at_infinity), 0.98) << "all depths have the same parallax";
  for (cv::Mat1b& mask : scene.masks) mask = mask_of(kHole);
  EXPECT_EQ(part(run_plane_sweep(scene), is_unchanged), 1);
}

TEST(PlaneSweep, HandlesAMaskOverTheWholeFrame) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.masks[0].setTo(255);
  expect_wall(run_plane_sweep(scene), 0.7);
  for (cv::Mat1b& mask : scene.masks) mask.setTo(255);
  EXPECT_EQ(part(run_plane_sweep(scene), is_unchanged), 1);
}

TEST(PlaneSweep, ChangesNothingWithoutOtherViews) {
  EXPECT_EQ(part(run_plane_sweep(wall(waves(96, 64, 1), {})), is_unchanged), 1);
}

TEST(PlaneSweep, ChangesNothingWithoutOverlap) {
  FlatScene scene = wall(waves(96, 64, 1));
  for (std::size_t i = 1; i < scene.views.size(); ++i) scene.views[i].camera_from_world.R.diagonal() << -1, 1, -1;
  EXPECT_EQ(part(run_plane_sweep(scene), is_unchanged), 1) << "the others face backward";
}

TEST(PlaneSweep, ChangesNothingWithoutAHole) {
  FlatScene scene = wall(waves(96, 64, 1));
  scene.masks[0].setTo(0);
  EXPECT_EQ(part(run_plane_sweep(scene), is_unchanged), 1);
}

int cheapest_label(const cv::Mat& sum, int x) {
  const float* s = sum.ptr<float>(0, x);
  return static_cast<int>(std::min_element(s, s + sum.channels()) - s);
}

TEST(SemiGlobal, NeighborsOutvoteAPixelUnlessStepsAreCheap) {
  cv::Mat cost(1, 9, CV_32FC(4));
  for (int x = 0; x < 9; ++x)
    for (int k = 0; k < 4; ++k) cost.ptr<float>(0, x)[k] = k == (x == 4 ? 3 : 1) ? 0 : (x == 4 ? 0.1F : 2.0F);
  const cv::Mat1b all(1, 9, uchar{1});
  EXPECT_EQ(cheapest_label(sum_path_costs(cost, all, {0.1F, 1.0F}), 4), 1);
  EXPECT_EQ(cheapest_label(sum_path_costs(cost, all, {0.01F, 0.02F}), 4), 3);
  cv::Mat1b separated = all.clone();
  separated(0, 3) = separated(0, 5) = 0;
  EXPECT_EQ(cheapest_label(sum_path_costs(cost, separated, {0.1F, 1.0F}), 4), 3) << "paths end at pixels that are not members";
}

}  // namespace
}  // namespace dvi::depth
