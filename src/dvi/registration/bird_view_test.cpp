#include "dvi/registration/bird_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dvi/core/random.h"

namespace dvi::registration {
namespace {

using Eigen::Vector3d;

/// A flat ground at `height` below the sensor, in the axes of a tilted sensor.
std::vector<scan_match::Feature> make_ground(const SE3& lidar_from_level, double height) {
  std::vector<scan_match::Feature> out;
  for (double x = -15; x < 15; x += 0.4)
    for (double y = -15; y < 15; y += 0.4) out.push_back({(lidar_from_level * Vector3d(x, y, -height)).cast<float>(), 0});
  return out;
}

TEST(BirdView, LevelsAnyMountingByTheGround) {
  const SE3 tilted{so3_exp({0.05, -0.08, 0}), Vector3d::Zero()};
  const SE3 level = level_from_lidar(make_ground(tilted, 2));
  for (const Vector3d& below : {Vector3d(3, 4, -2), Vector3d(-10, 2, -2)}) EXPECT_NEAR((level * (tilted * below)).z(), 0, 0.01);
  EXPECT_NEAR(level.t.z(), 2, 0.01) << "meters above the ground";
  EXPECT_TRUE(level_from_lidar({}).R.isIdentity()) << "no ground";
}

TEST(BirdView, RoadAndCurbsAreNotUpright) {
  std::vector<scan_match::Feature> points = make_ground({}, 0);
  for (float z = 0; z < 3; z += 0.1F) points.push_back({{5, 5, z}, 0});
  for (const Vector3d& p : extract_upright_points(points, {})) EXPECT_LT((p - Vector3d(5, 5, p.z())).norm(), 0.75);
}

TEST(BirdView, FindsThePoseInAnyHeading) {
  Random random(3);
  std::vector<Vector3d> a;
  for (int i = 0; i < 120; ++i) {
    const Vector3d at(random.uniform(-40, 40), random.uniform(-15, 15), 0);
    for (double x = 0; x < 1; x += 0.25) a.push_back(at + Vector3d(x, 0, 1));
  }
  const BirdView view = make_bird_view(a);
  for (const double heading : {0.0, 0.7, 3.1, -1.9}) {
    const SE3 a_from_b{so3_exp({0, 0, heading}), {7, -4, 0}};
    std::vector<Vector3d> b;
    for (const Vector3d& p : a) b.push_back(a_from_b.inverse() * p);
    const std::vector<PlacementGuess> found = correlate(view, make_rotated_views(b), 3);
    ASSERT_EQ(found.size(), 3);
    const SE3 off = found.front().a_from_b.inverse() * a_from_b;
    EXPECT_LT(off.t.norm(), 0.8) << heading;
    EXPECT_LT(so3_log(off.R).norm(), 0.03) << heading;
    EXPECT_GT(found[0].score, 2 * found[1].score) << heading;
  }
}

}  // namespace
}  // namespace dvi::registration
