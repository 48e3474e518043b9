#include "dvi/depth/depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dvi/core/random.h"
#include "dvi/depth/delaunay.h"
#include "dvi/depth/test_map.h"
#include "dvi/depth/visibility_map.h"

namespace dvi::depth {
namespace {

map::VisiblePoint point_at(double u, double v) {
  return {static_cast<float>(u), static_cast<float>(v), 1, Eigen::Vector3f::Zero(), 0};
}

struct TriangulationCheck {
  double area_px = 0;  ///< sum of the signed areas
  int triangles = 0;
  int reversed = 0;  ///< triangles with another direction of rotation, or without area
  int inside = 0;    ///< pairs of a triangle and a point inside its circumcircle
};

TriangulationCheck check_triangulation(const std::vector<map::VisiblePoint>& points) {
  TriangulationCheck out;
  triangulate(points, [&](const std::array<std::size_t, 3>& t) {
    const Eigen::Vector2d a(points[t[0]].u, points[t[0]].v), b(points[t[1]].u, points[t[1]].v),
        c(points[t[2]].u, points[t[2]].v);
    const Eigen::Vector2d ab = b - a, ac = c - a;
    const double d = 2 * (ab.x() * ac.y() - ab.y() * ac.x());
    out.area_px += d / 4;
    ++out.triangles;
    if (d < 1e-9) {
      ++out.reversed;
      return;
    }
    const Eigen::Vector2d center = a + Eigen::Vector2d(ac.y() * ab.squaredNorm() - ab.y() * ac.squaredNorm(),
                                                       ab.x() * ac.squaredNorm() - ac.x() * ab.squaredNorm()) /
                                           d;
    for (const map::VisiblePoint& p : points)
      if ((Eigen::Vector2d(p.u, p.v) - center).norm() < (a - center).norm() - 1e-6) ++out.inside;
  });
  return out;
}

TEST(Triangulate, TrianglesCoverTheHullOnceAndHaveEmptyCircumcircles) {
  for (const double step : {1.0, 0.0625}) {
    Random random(1);
    std::vector<map::VisiblePoint> points{point_at(0, 0), point_at(100, 0), point_at(0, 100), point_at(100, 100)};
    for (int i = 0; i < 400; ++i)
      points.push_back(point_at(step * random.below(cvRound(100 / step)), step * random.below(cvRound(100 / step))));
    const TriangulationCheck found = check_triangulation(points);
    EXPECT_NEAR(found.area_px, 100 * 100, 1e-6);
    EXPECT_EQ(found.reversed, 0);
    EXPECT_EQ(found.inside, 0);
  }
}

TEST(Triangulate, PointsOfAGridAreCocircularAndStillCoveredOnce) {
  std::vector<map::VisiblePoint> points;
  for (int v = 0; v < 20; ++v)
    for (int u = 0; u < 30; ++u) points.push_back(point_at(u, v));
  std::reverse(points.begin(), points.end());
  const TriangulationCheck found = check_triangulation(points);
  EXPECT_NEAR(found.area_px, 29 * 19, 1e-9);
  EXPECT_EQ(found.triangles, 2 * 29 * 19);
  EXPECT_EQ(found.reversed + found.inside, 0);
}

TEST(Triangulate, ManyPointsOnALineAndOneBesideIt) {
  for (const auto& [u, v] : {std::pair(50.0, 70.0), {50.0, 5.0}, {-3.0, 20.0}, {200.0, 20.0}})
    for (const bool upright : {false, true}) {
      std::vector<map::VisiblePoint> points;
      for (int i = 0; i < 100; ++i) points.push_back(upright ? point_at(20, i) : point_at(i, 20));
      points.push_back(upright ? point_at(v, u) : point_at(u, v));
      const TriangulationCheck found = check_triangulation(points);
      EXPECT_EQ(found.triangles, v == 20.0 ? 0 : 99);
      EXPECT_EQ(found.reversed + found.inside, 0);
    }
}

TEST(Triangulate, FewOrEqualPointsHaveNoTriangles) {
  EXPECT_EQ(check_triangulation({}).triangles, 0);
  EXPECT_EQ(check_triangulation({point_at(1, 2)}).triangles, 0);
  EXPECT_EQ(check_triangulation({point_at(1, 2), point_at(3, 4)}).triangles, 0);
  EXPECT_EQ(check_triangulation({point_at(1, 2), point_at(1, 2), point_at(1.01, 2), point_at(1, 2)}).triangles, 0);
  EXPECT_EQ(check_triangulation({point_at(1, 2), point_at(1, 2), point_at(5, 2), point_at(1, 9)}).triangles, 1);
}

TEST(Triangulate, IsExactOverTheWidthOfALargeImage) {
  Random random(2);
  std::vector<map::VisiblePoint> points{point_at(0, 0), point_at(16000, 0), point_at(0, 12000), point_at(16000, 12000)};
  for (int i = 0; i < 60; ++i) points.push_back(point_at(random.below(16000), random.below(12000)));
  const TriangulationCheck found = check_triangulation(points);
  EXPECT_NEAR(found.area_px, 16000.0 * 12000, 1e-3);
  EXPECT_EQ(found.reversed + found.inside, 0);
}

TEST(DepthMap, IsExactOnASlantedPlane) {
  map::StaticMap map;  // the ground, 1.6 m below, sampled in rows whose spacing grows with distance, as those of a LiDAR
  for (double x = 3; x < 60; x *= 1.06)
    for (double y = -12; y <= 12; y += 0.2) add(map, x, y, -1.6);
  finish(map);
  const View view = test_view();
  const DepthMap depth = compute_depth_map(map, view, {});
  double worst = 0;
  int known = 0;
  for (int y = 115; y < 180; ++y)
    for (int x = 110; x < 210; ++x) {
      const double truth = 1.6 * view.camera.fy / (y - view.camera.cy);
      if (truth > 50) continue;
      ASSERT_TRUE(DepthMap::is_surface(depth.z(y, x))) << x << " " << y;
      worst = std::max(worst, std::abs(depth.z(y, x) / truth - 1));
      ++known;
    }
  EXPECT_GT(known, 5000);
  EXPECT_LT(worst, 0.01);
}

TEST(DepthMap, PixelsAboveTheTopmostReturnAreSky) {
  map::StaticMap map;
  for (double y = -8; y <= 8; y += 0.1)
    for (double z = -1.6; z <= 2; z += 0.1) add(map, 20, y, z);
  finish(map);
  const DepthMap depth = compute_depth_map(map, test_view(), {});
  EXPECT_NEAR(depth.z(100, 160), 20, 0.05);
  EXPECT_TRUE(std::isinf(depth.z(60, 160))) << "2 m up at 20 m is row 74.5";
  EXPECT_TRUE(std::isinf(depth.z(100, 10))) << "the column has no return";
  EXPECT_EQ(depth.z(180, 160), DepthMap::kUnknown) << "below the lowest return";
  EXPECT_EQ(depth.sigma(60, 160), 0);
  EXPECT_GT(depth.sigma(100, 160), 0);
}

// A pole at 10 m in front of a wall at 20 m, both densely sampled.
map::StaticMap pole_and_wall() {
  map::StaticMap map;
  for (double y = -8; y <= 8; y += 0.08)
    for (double z = -3; z <= 5; z += 0.08) add(map, 20, y, z);
  for (double y = -0.2; y <= 0.2; y += 0.05)
    for (double z = -3; z <= 3; z += 0.05) add(map, 10, y, z);
  finish(map);
  return map;
}

TEST(DepthMap, EdgesAreSplitNotInterpolated) {
  const DepthMap depth = compute_depth_map(pole_and_wall(), test_view(), {});
  int between = 0, pole = 0;
  for (int x = 130; x < 190; ++x) {
    const float z = depth.z(100, x);
    pole += std::abs(z - 10) < 0.3 ? 1 : 0;
    between += z > 10.5 && z < 19.5 ? 1 : 0;
  }
  EXPECT_EQ(between, 0);
  EXPECT_NEAR(pole, 0.4 / 10 * 250, 3) << "the pole keeps its width";
  DepthOptions linear;
  linear.split_edges = false;
  linear.median_px = 0;
  linear.splat_m = 0;
  const DepthMap interpolated = compute_depth_map(pole_and_wall(), test_view(), linear);
  int interpolated_pixels = 0;
  for (int x = 130; x < 190; ++x)
    interpolated_pixels += interpolated.z(100, x) > 10.5F && interpolated.z(100, x) < 19.5F ? 1 : 0;
  EXPECT_GT(interpolated_pixels, 0) << "the published form interpolates across edges";
}

TEST(DepthMap, ASparseNearSurfaceOccludesTheFarOne) {
  map::StaticMap map;
  for (double y = -8; y <= 8; y += 0.05)
    for (double z = -3; z <= 3; z += 0.05) add(map, 30, y, z);
  for (double y = -2; y <= 2; y += 0.1)
    for (double z = -1; z <= 1; z += 0.1) add(map, 6, y, z);  // one of sixteen pixels
  finish(map);
  const DepthMap depth = compute_depth_map(map, test_view(), {});
  int through = 0;
  for (int y = 70; y < 130; ++y)
    for (int x = 90; x < 230; ++x) through += depth.z(y, x) > 7 ? 1 : 0;
  EXPECT_EQ(through, 0);
}

TEST(VisibilityMap, OccludesDepthsBehindTheFarthestSurface) {
  DepthMap depth{cv::Mat1f(7, 9, 10.0F), cv::Mat1f(7, 9, 0.0F)};
  depth.z.colRange(6, 9) = 20.0F;
  depth.z(6, 0) = DepthMap::kUnknown;
  cv::Mat1b mask(7, 9, uchar{0});
  const VisibilityMap map = make_visibility_map(depth, mask);
  EXPECT_FALSE(map.occludes({2, 2}, 10.4, 0.05));
  EXPECT_TRUE(map.occludes({2, 2}, 10.6, 0.05));
  EXPECT_FALSE(map.occludes({5.5F, 2}, 19, 0.05)) << "both surfaces at the edge are accepted";
  EXPECT_TRUE(map.occludes({8, 6}, 22, 0.05));
  EXPECT_FALSE(map.occludes({0, 6}, 1000, 0.05)) << "unknown depth does not occlude";
  EXPECT_FALSE(map.occludes({8.9F, 6.9F}, 20, 0.05)) << "the last pixel is inside";
  mask(3, 3) = 255;
  const VisibilityMap masked = make_visibility_map(depth, mask);
  EXPECT_TRUE(masked.is_masked({3, 3}));
  EXPECT_TRUE(masked.is_masked({2.5F, 3}));
  EXPECT_TRUE(masked.is_masked({3.9F, 3.9F}));
  EXPECT_FALSE(masked.is_masked({2, 3})) << "exact to the pixel, not to the block";
  EXPECT_FALSE(masked.is_masked({4, 3}));
  EXPECT_FALSE(masked.is_masked({3, 2}));
}

TEST(VisibilityMap, AllowsForTheUncertaintyOfDepth) {
  DepthMap depth{cv::Mat1f(20, 40, 10.0F), cv::Mat1f(20, 40, 0.5F)};
  depth.z.colRange(20, 40) = 20.0F;
  depth.z(2, 38) = DepthMap::kUnknown;
  const VisibilityMap map = make_visibility_map(depth, cv::Mat1b(20, 40, uchar{0}));
  EXPECT_FALSE(map.occludes({8, 8}, 10.9, 0)) << "within two standard deviations";
  EXPECT_TRUE(map.occludes({8, 8}, 11.1, 0));
  EXPECT_FALSE(map.is_farther({8, 8}, 9.1, 0));
  EXPECT_TRUE(map.is_farther({8, 8}, 8.8, 0));
  EXPECT_FALSE(map.is_farther({8, 8}, 8.8, 0.05));
  EXPECT_FALSE(map.is_farther({20, 8}, 10, 0)) << "both surfaces at the edge are accepted";
  EXPECT_TRUE(map.is_farther({30, 8}, 10, 0));
  EXPECT_FALSE(map.is_farther({38, 2}, 10, 0)) << "unknown depth may be any";
  EXPECT_EQ(map.clearance_px({20, 8}), 0);
  EXPECT_NEAR(map.clearance_px({10, 10}), 7, 1) << "from the block to the edge or the border of the image";
}

TEST(DepthMap, OfAnEmptyMapIsSky) {
  const DepthMap depth = compute_depth_map(map::StaticMap(), test_view(), {});
  EXPECT_EQ(depth.z.size(), cv::Size(320, 200));
  EXPECT_TRUE(std::isinf(depth.z(0, 0)));
}

}  // namespace
}  // namespace dvi::depth
