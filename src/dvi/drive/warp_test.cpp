#include "dvi/drive/warp.h"

#include <limits>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/random.h"
#include "dvi/testing/flat_scene.h"

namespace dvi {
namespace {

View looking_ahead() {
  View view;
  view.camera = {320, 240, 200, 200, 159.5, 119.5, {}};
  return view;
}

TEST(Warp, MapsAPlaneByItsDisparity) {
  FlatScene scene(waves(60, 40, 1), cv::Mat1b(40, 60, uchar{0}));
  scene.add_source(7, scene.images[0]);
  const Warp warp(scene.views[0], scene.views[1]);
  for (int y = 0; y < 40; y += 3)
    for (int x = 0; x < 60; x += 3)
      EXPECT_EQ(warp({x, y}, static_cast<float>(FlatScene::kDepthM)),
                cv::Point2f(static_cast<float>(x + 7), static_cast<float>(y)));
}

TEST(Warp, ReturnsToItsOriginFromTheSource) {
  Random random(2);
  const View target = looking_ahead();
  View source = looking_ahead();
  source.camera_from_world = {so3_exp({0.02, -0.05, 0.01}), {0.4, -0.1, -1.5}};
  const Warp there(target, source);
  for (int i = 0; i < 200; ++i) {
    const cv::Point pixel(static_cast<int>(random.below(320)), static_cast<int>(random.below(240)));
    const double z = random.uniform(5, 60);
    const Eigen::Vector3d in_source = source.camera_from_world * Eigen::Vector3d(z * target.camera.ray({pixel.x, pixel.y}));
    const auto at = there(pixel, static_cast<float>(z));
    ASSERT_TRUE(at);
    const Eigen::Vector2d exact = source.camera.project(in_source);
    EXPECT_NEAR(at->x, exact.x(), 1 / 32.0 + 1e-4);  // quantized to sixteenths
    EXPECT_NEAR(at->y, exact.y(), 1 / 32.0 + 1e-4);
  }
}

TEST(Warp, RotatesTheSkyWithoutTranslation) {
  const View target = looking_ahead();
  View source = looking_ahead();
  source.camera_from_world.t = {5, 1, -20};
  constexpr float kSky = std::numeric_limits<float>::infinity();
  EXPECT_EQ(Warp(target, source)({100, 30}, kSky), cv::Point2f(100, 30));
  source.camera_from_world.R = so3_exp({0, 0.1, 0});
  EXPECT_NE(Warp(target, source)({100, 30}, kSky), cv::Point2f(100, 30));
}

TEST(Warp, ReturnsNothingWithoutDepthOrBehindTheSource) {
  const View target = looking_ahead();
  View source = looking_ahead();
  source.camera_from_world.t.z() = -10;  // 10 m ahead of the target
  const Warp warp(target, source);
  EXPECT_TRUE(warp({10, 10}, 12));
  for (const float z : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(), 8.0F}) EXPECT_FALSE(warp({10, 10}, z)) << z;
}

TEST(NeighborInSource, KeepsTheMotionOfNeighbors) {
  const cv::Point2f shown(50.5, 20);
  EXPECT_EQ(find_neighbor_in_source({{10, 10}, cv::Point2f(50, 20)}, shown, {{11, 10}, cv::Point2f(52, 20.25)}),
            cv::Point2f(52.5, 20.25));
  EXPECT_EQ(find_neighbor_in_source({{10, 10}, std::nullopt}, shown, {{11, 10}, cv::Point2f(52, 20)}), cv::Point2f(51.5, 20));
  EXPECT_EQ(find_neighbor_in_source({{10, 10}, cv::Point2f(50, 20)}, shown, {{10, 9}, std::nullopt}), cv::Point2f(50.5, 19));
}

TEST(CanSample, RequiresCellsWithinTheImageAndOutsideTheMask) {
  cv::Mat1b mask(10, 20, uchar{0});
  mask(5, 8) = 255;
  EXPECT_TRUE(can_sample(mask, {0, 0}));
  EXPECT_TRUE(can_sample(mask, {19, 9}));  // the last pixel needs no neighbor
  for (const cv::Point2f outside :
       {cv::Point2f(-0.0625F, 3), cv::Point2f(19.0625F, 3), cv::Point2f(3, -1), cv::Point2f(3, 9.5F)})
    EXPECT_FALSE(can_sample(mask, outside)) << outside;
  for (const cv::Point2f blend :
       {cv::Point2f(8, 5), cv::Point2f(7.0625F, 5), cv::Point2f(8.9375F, 5.9375F), cv::Point2f(8, 4.5F)})
    EXPECT_FALSE(can_sample(mask, blend)) << blend;
  for (const cv::Point2f clear : {cv::Point2f(7, 5), cv::Point2f(9, 5), cv::Point2f(8, 4), cv::Point2f(8.5F, 6)})
    EXPECT_TRUE(can_sample(mask, clear)) << clear;
  EXPECT_FALSE(can_sample(mask, {std::numeric_limits<float>::quiet_NaN(), 0}));
}

TEST(CanSample, RequiresFootprintsOutsideTheMask) {
  Random random(3);
  cv::Mat1b mask(16, 24, uchar{0});
  mask(7, 12) = mask(2, 3) = 255;
  cv::Mat3b image;
  cv::merge(std::vector<cv::Mat>{mask, mask, mask}, image);
  int allowed = 0;
  for (int i = 0; i < 2000; ++i) {
    const cv::Point2f at = quantize(random.uniform(2, 21), random.uniform(2, 13));  // completely inside the image
    const cv::Vec2b footprint(static_cast<uchar>(1 + random.below(4)), static_cast<uchar>(1 + random.below(4)));
    const bool clear = box_mean(image, at, footprint) == cv::Vec3f(0, 0, 0);
    ASSERT_EQ(can_sample(mask, at, footprint), clear) << at << " " << footprint;
    allowed += clear ? 1 : 0;
  }
  EXPECT_GT(allowed, 500);
  EXPECT_LT(allowed, 1900);
  EXPECT_FALSE(can_sample(mask, {0.5F, 8}, {4, 1}));  // extends beyond the image
  EXPECT_TRUE(can_sample(mask, {1.5F, 8}, {4, 1}));
}

}  // namespace
}  // namespace dvi
