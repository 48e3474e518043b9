#include "dvi/synth/solid.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/core/random.h"

namespace dvi::synth {
namespace {

using Eigen::Vector3d;

TexturePtr white(const cv::Mat1b& alpha = {}) {
  return std::make_shared<Texture>(cv::Mat3b(8, 8, cv::Vec3b(255, 255, 255)), alpha);
}

Ray toward(const Vector3d& origin, const Vector3d& target) { return {origin, (target - origin).normalized()}; }

TEST(Solid, FindsTheNearestSurfaceLikeBruteForce) {
  Random random(5);
  Solid all;
  std::vector<Solid> single(80);
  for (Solid& one : single) {
    const Vector3d at(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    const Vector3d right(random.normal(), random.normal(), random.normal()),
        up(random.normal(), random.normal(), random.normal());
    for (Solid* solid : {&one, &all}) solid->add({at, at + right, at + up + 0.2 * right, at + up + 0.7 * right}, white());
    one.finish();
  }
  all.finish();
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Ray ray = toward({20, 1, 2}, {random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)});
    double nearest = std::numeric_limits<double>::infinity();
    for (const Solid& one : single) nearest = std::min(nearest, one.trace(ray, nearest).t);
    const Hit hit = all.trace(ray, std::numeric_limits<double>::infinity());
    EXPECT_EQ(hit.t, nearest);
    hits += hit ? 1 : 0;
  }
  EXPECT_GT(hits, 300);
}

TEST(Solid, HasCompleteLeaningTrapezoids) {
  Solid solid;
  solid.add({{0, 0, 0}, {1, 0, 0}, {3, 0, 2}, {3.8, 0, 2}}, white());
  solid.finish();
  const auto hit = [&](double x, double z) { return bool(solid.trace(toward({x, -5, z}, {x, 0, z}), 100)); };
  EXPECT_TRUE(hit(0.05, 0.01));
  EXPECT_TRUE(hit(3.7, 1.99));
  EXPECT_TRUE(hit(1.55, 1));
  EXPECT_TRUE(hit(2.35, 1));
  EXPECT_FALSE(hit(1.45, 1));
  EXPECT_FALSE(hit(2.45, 1));
  EXPECT_FALSE(hit(0.5, 1));
}

TEST(Solid, LetsRaysPassThroughHoles) {
  cv::Mat1b alpha(8, 8, uchar{255});
  alpha(cv::Rect(0, 0, 4, 8)).setTo(0);
  Solid solid;
  solid.add({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}}, white(alpha));
  solid.finish();
  EXPECT_FALSE(solid.trace(toward({0.3, -2, 0.5}, {0.3, 0, 0.5}), 100));
  EXPECT_TRUE(solid.trace(toward({0.7, -2, 0.5}, {0.7, 0, 0.5}), 100));
}

TEST(Solid, HasRoundCylinders) {
  Solid solid;
  solid.add_cylinder({1, 2, 0}, 0.5, 3, white());
  solid.finish();
  EXPECT_NEAR(solid.trace(toward({-5, 2, 1}, {1, 2, 1}), 100).t, 5.5, 1e-9);
  EXPECT_FALSE(solid.trace(toward({-5, 2.51, 1}, {1, 2.51, 1}), 100));
  EXPECT_FALSE(solid.trace(toward({-5, 2, 3.1}, {1, 2, 3.1}), 100));
}

}  // namespace
}  // namespace dvi::synth
