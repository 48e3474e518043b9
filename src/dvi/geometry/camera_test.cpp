#include "dvi/geometry/camera.h"

#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi {
namespace {

const Camera kPlain{1280, 720, 1000, 990, 640.5, 359.5, {}};
const Camera kBarrel{1280, 720, 1000, 990, 640.5, 359.5, {-0.3, 0.1, 0.001, -0.0005, -0.01}};
// The distortion is as strong as that of lenses in published driving data sets.
const Camera kStrong{1392, 512, 984, 980, 690, 233, {-0.3728, 0.2037, 0.002219, 0.001383, -0.07233}};

TEST(Camera, ProjectsTheOpticalAxisToThePrincipalPoint) {
  for (const Camera& camera : {kPlain, kBarrel}) {
    const Eigen::Vector2d p = camera.project({0, 0, 7});
    EXPECT_EQ(p, Eigen::Vector2d(640.5, 359.5));
  }
}

TEST(Camera, HasPositiveAxesToTheRightAndDown) {
  EXPECT_EQ(kPlain.project({1, 0, 10}), Eigen::Vector2d(740.5, 359.5));
  EXPECT_EQ(kPlain.project({0, 1, 10}), Eigen::Vector2d(640.5, 458.5));
}

// The formula of OpenCV's documentation, written for one point.
TEST(Camera, HasBrownsDistortion) {
  const double x = 0.3, y = -0.2, r2 = x * x + y * y;
  const auto [k1, k2, p1, p2, k3] = kBarrel.distortion;
  const double radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  const Eigen::Vector2d p = kBarrel.project({0.6, -0.4, 2});
  EXPECT_NEAR(p.x(), 1000 * u + 640.5, 1e-10);
  EXPECT_NEAR(p.y(), 990 * v + 359.5, 1e-10);
}

TEST(Camera, ProjectsTheRayOfEachPixelBackToThePixel) {
  for (const Camera& camera : {kPlain, kBarrel, kStrong})
    for (int y = 0; y < camera.height; y += 13)
      for (int x = 0; x < camera.width; x += 13) {
        const Eigen::Vector3d ray = camera.ray({x, y});
        ASSERT_EQ(ray.z(), 1);
        ASSERT_LT((camera.project(ray * 12.5) - Eigen::Vector2d(x, y)).norm(), 1e-6) << x << ' ' << y;
        ASSERT_TRUE(camera.in_front(ray)) << x << ' ' << y;
      }
}

TEST(Camera, RecoversPointsFromPixelAndDepth) {
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const double z = random.uniform(1, 80);
    const Eigen::Vector3d x(random.uniform(-0.6, 0.6) * z, random.uniform(-0.35, 0.35) * z, z);
    for (const Camera& camera : {kPlain, kBarrel}) ASSERT_LT((camera.ray(camera.project(x)) * z - x).norm(), 1e-6 * z);
  }
}

TEST(Camera, ContainsPositionsWithFourNeighbors) {
  EXPECT_TRUE(kPlain.contains({0, 0}));
  EXPECT_TRUE(kPlain.contains({1279, 719}));
  EXPECT_FALSE(kPlain.contains({-0.01, 0}));
  EXPECT_FALSE(kPlain.contains({1279.01, 0}));
  EXPECT_FALSE(kPlain.contains({0, 719.01}));
}

TEST(Camera, ExcludesDirectionsThatTheDistortionFoldsBack) {
  EXPECT_FALSE(kPlain.in_front({0, 0, -1}));
  EXPECT_FALSE(kPlain.in_front({0, 0, 0}));
  EXPECT_TRUE(kPlain.in_front({50, 0, 1}));
  const Camera folding{1280, 720, 1000, 1000, 640, 360, {-0.4, 0, 0, 0, 0}};  // r(1 - 0.4 r^2) increases up to r = 0.913
  EXPECT_TRUE(folding.in_front({0.90, 0, 1}));
  EXPECT_FALSE(folding.in_front({0.92, 0, 1}));
  EXPECT_TRUE(folding.contains(folding.project({1.5, 0, 1})));  // although it is projected into the image
  EXPECT_FALSE(folding.in_front({1.5, 0, 1}));
}

}  // namespace
}  // namespace dvi
