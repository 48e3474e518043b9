#include "dvi/depth/surfel_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "dvi/depth/depth.h"
#include "dvi/depth/test_map.h"

namespace dvi::depth {
namespace {

template <class Shadow>
void add_ground(map::StaticMap& map, double far, const Shadow& shadow) {
  for (double x = 4; x < far; x *= 1.03)
    for (double y = -10; y <= 10; y += 0.15)
      if (!shadow(x, y)) add(map, x, y, -1.6);
}

struct WallAhead {
  double x, half_width, bottom, top;
};

void add_wall(map::StaticMap& map, const WallAhead& wall) {
  for (double y = -wall.half_width; y <= wall.half_width; y += 0.1)
    for (double z = wall.bottom; z <= wall.top; z += 0.1) add(map, wall.x, y, z);
}

double ground_depth(const View& view, int y) { return 1.6 * view.camera.fy / (y - view.camera.cy); }

Surfel surfel_at(const Eigen::Vector3f& world, const Eigen::Vector3f& normal) {
  Surfel s;
  s.world = world;
  s.normal = normal;
  s.has_normal = true;
  return s;
}

TEST(ClassifyJoint, DistinguishesConnectionsOfSurfaces) {
  const Eigen::Vector3f up(0, 0, 1), back(-1, 0, 0), left(0, 1, 0);
  const Surfel ground = surfel_at({10, 0, 0}, up), wall = surfel_at({12, 0, 1}, back), pole = surfel_at({11, 0, 1}, back);
  EXPECT_EQ(classify_joint(ground, surfel_at({18, 2, 0.1F}, up)), Joint::same);
  EXPECT_EQ(classify_joint(ground, surfel_at({10.2F, 0, 0.2F}, up)), Joint::step) << "a curb";
  EXPECT_EQ(classify_joint(ground, wall), Joint::concave);
  EXPECT_EQ(classify_joint(wall, ground), Joint::concave);
  EXPECT_EQ(classify_joint(surfel_at({12, 1, 1}, back), surfel_at({14, 2, 1}, left)), Joint::convex) << "the corner of a box";
  EXPECT_EQ(classify_joint(pole, wall), Joint::step);
  EXPECT_EQ(classify_joint(pole, surfel_at({16, 0, 0}, up)), Joint::step) << "the ground behind a pole";
}

TEST(SurfelMesh, EstimatesNormalsOfSparseReturnsFromNeighbors) {
  map::StaticMap map;  // too sparse for normals of the map
  add_ground(map, 60, [](double, double) { return false; });
  finish(map);
  const SurfelMesh mesh = make_surfel_mesh(map, test_view(), {.splat_m = 0.07, .occlusion_tolerance = 0.05, .max_slope = 10});
  ASSERT_GT(mesh.surfels.size(), 1000U);
  const auto level = std::count_if(mesh.surfels.begin(), mesh.surfels.end(), [](const Surfel& s) {
    return s.has_normal && s.normal.z() > 0.999F && s.spacing({1, 0}) > 0;
  });
  EXPECT_GT(static_cast<double>(level), 0.98 * static_cast<double>(mesh.surfels.size()));
}

TEST(DepthMap, GroundContinuesThroughAGapUpToTheWallBehind) {
  map::StaticMap map;  // a vehicle occluded the ground from 8 m to the wall, and the lower part of the wall, in all scans
  add_ground(map, 24, [](double x, double y) { return x > 8 && std::abs(y) < 2; });
  add_wall(map, {24, 10, -0.4, 3});
  finish(map);
  const View view = test_view();
  const DepthMap depth = compute_depth_map(map, view, {});
  int wrong = 0;
  for (int y = 105; y < 145; ++y)
    for (int x = 145; x < 175; ++x) {
      const double truth = std::min(24.0, ground_depth(view, y));
      if (std::abs(y - 116) > 1 && std::abs(depth.z(y, x) / truth - 1) > 0.02) ++wrong;
    }
  EXPECT_EQ(wrong, 0);
}

TEST(DepthMap, UprightSurfacesExtendToTheGroundInUnscannedAreas) {
  map::StaticMap map;  // a box at 15 m, of which the top 40 cm were scanned, in front of a wall
  add_ground(map, 40, [](double x, double y) { return x > 9 && std::abs(y) < 3; });
  add_wall(map, {15, 1, -0.7, -0.3});
  add_wall(map, {40, 12, -0.2, 4});
  finish(map);
  const View view = test_view();
  const DepthMap depth = compute_depth_map(map, view, {});
  int box = 0, ground = 0;
  for (int x = 150; x < 170; ++x) {
    for (int y = 107; y < 125; ++y) box += std::abs(depth.z(y, x) - 15) < 0.3 ? 1 : 0;
    for (int y = 128; y < 140; ++y) ground += std::abs(depth.z(y, x) / ground_depth(view, y) - 1) < 0.02 ? 1 : 0;
  }
  EXPECT_GT(box, 0.95 * 20 * 18) << "its foot is at row 126";
  EXPECT_GT(ground, 0.95 * 20 * 12);
}

TEST(DepthMap, SuspendedSurfacesAreNotExtended) {
  map::StaticMap map;  // a sign at 10 m, above an unscanned area that is larger than its distance to the ground
  add_ground(map, 40, [](double x, double y) { return x > 25 && std::abs(y) < 4; });
  add_wall(map, {10, 0.5, 0.2, 1});
  add_wall(map, {40, 12, -0.2, 4});
  finish(map);
  const DepthMap depth = compute_depth_map(map, test_view(), {});
  int extended = 0;
  for (int y = 98; y < 115; ++y)
    for (int x = 150; x < 170; ++x) extended += depth.z(y, x) < 15 ? 1 : 0;
  EXPECT_EQ(extended, 0);
}

TEST(DepthMap, SigmaIsLargerAtGrazingAngles) {
  map::StaticMap map;
  add_ground(map, 60, [](double, double) { return false; });
  add_wall(map, {60, 10, -1.6, 3});
  finish(map);
  const DepthMap depth = compute_depth_map(map, test_view(), {});
  EXPECT_LT(depth.sigma(180, 160), 0.05);
  EXPECT_GT(depth.sigma(110, 160), 0.15) << "at 38 m, 1 cm of height is a quarter of a meter in depth";
  EXPECT_LT(depth.sigma(95, 160), 0.03) << "the wall";
}

}  // namespace
}  // namespace dvi::depth
