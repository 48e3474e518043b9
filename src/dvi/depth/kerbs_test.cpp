#include "dvi/depth/kerbs.h"

#include <gtest/gtest.h>

#include "dvi/depth/depth.h"
#include "dvi/depth/test_map.h"

namespace dvi::depth {
namespace {

constexpr double kKerb = 2.55, kHeight = 0.14, kRoad = -1.6;  // the pavement is to the left

double level(double y) { return y > kKerb ? kRoad + kHeight : kRoad; }

/// Road and pavement with their normals, nothing between 9 and 22 m from `hole_from` to `hole_to` (metres left).
map::StaticMap street(double height, double hole_from, double hole_to) {
  map::StaticMap map;
  for (double x = 4; x < 45; x += 0.06 + 0.012 * x)
    for (double y = -8; y <= 10; y += 0.1)
      if (x < 9 || x > 22 || y < hole_from || y > hole_to) add(map, x, y, y > kKerb ? kRoad + height : kRoad);
  for (map::MapPoint& p : map.points) p.normal = Eigen::Vector3f::UnitZ();
  finish(map);
  return map;
}

TEST(Kerbs, GoOnThroughWhatNobodyScanned) {
  const View view = test_view();
  const DepthMap depth = depth_map(street(kHeight, -1, 6), view, {});
  int wrong = 0, all = 0;
  for (int y = 119; y < 143; ++y)
    for (int x = 70; x < 175; ++x) {
      const double down = (y - view.camera.cy) / view.camera.fy, left = (view.camera.cx - x) / view.camera.fx;
      const double pavement = -(kRoad + kHeight) / down, road = -kRoad / down;
      if (left * pavement < kKerb + 0.1 && left * road > kKerb - 0.1) continue;  // the face of the kerb
      wrong += std::abs(depth.z(y, x) / (left * road > kKerb ? pavement : road) - 1) < 0.02 ? 0 : 1;
      ++all;
    }
  EXPECT_GT(all, 2000);
  EXPECT_LT(wrong, 0.02 * all);
}

TEST(Kerbs, AreNotSeenInLevelGround) {
  const View view = test_view();
  const map::StaticMap map = street(0, -1, 6);
  EXPECT_TRUE(Kerbs(surfel_mesh(map, view, 0.07, 0.05, 10), eye_of(view)).empty());
  EXPECT_TRUE(Kerbs(SurfelMesh(), eye_of(view)).empty());
}

TEST(Kerbs, AreFoundWhereverTheStreetPoints) {
  const View view = test_view();
  for (const double angle : {0.0, 0.3, -0.5}) {
    const Eigen::Rotation2Dd turn(angle);
    map::StaticMap map;
    for (double x = 4; x < 40; x += 0.06 + 0.012 * x)
      for (double y = -8; y <= 10; y += 0.1) {
        const Eigen::Vector2d p = turn * Eigen::Vector2d(x, y);
        add(map, p.x(), p.y(), level(y));
      }
    finish(map);
    EXPECT_FALSE(Kerbs(surfel_mesh(map, view, 0.07, 0.05, 10), eye_of(view)).empty()) << angle;
  }
}

}  // namespace
}  // namespace dvi::depth
