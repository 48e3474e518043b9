#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "dvi/depth/depth.h"
#include "dvi/depth/test_map.h"

// Compares depth maps of simulated scans by a LiDAR with 64 beams with the exact depth of the scanned shapes.

namespace dvi::depth {
namespace {

using Eigen::Vector3d;

/// Returns the distance along `ray` from `origin` to a surface, or kNever.
using Shape = std::function<double(const Vector3d& origin, const Vector3d& ray)>;
constexpr double kNever = std::numeric_limits<double>::infinity();

Shape plane(const Vector3d& point, const Vector3d& normal) {
  return [=](const Vector3d& origin, const Vector3d& ray) {
    const double distance = normal.dot(point - origin) / normal.dot(ray);
    return distance > 0 ? distance : kNever;
  };
}

/// The part of a plane where `part` holds.
Shape plane(const Vector3d& point, const Vector3d& normal, const std::function<bool(const Vector3d&)>& part) {
  return [=, whole = plane(point, normal)](const Vector3d& origin, const Vector3d& ray) {
    const double distance = whole(origin, ray);
    return distance < kNever && part(origin + distance * ray) ? distance : kNever;
  };
}

/// An upright cylinder.
Shape pole(double x, double y, double radius, double top) {
  return [=](const Vector3d& origin, const Vector3d& ray) {
    const Eigen::Vector2d o(origin.x() - x, origin.y() - y), r = ray.head<2>();
    const double a = r.squaredNorm(), b = o.dot(r), root = b * b - a * (o.squaredNorm() - radius * radius);
    if (root < 0) return kNever;
    const double distance = (-b - std::sqrt(root)) / a;
    return distance > 0 && origin.z() + distance * ray.z() < top ? distance : kNever;
  };
}

struct Place {
  std::vector<Shape> shapes;

  double distance(const Vector3d& origin, const Vector3d& ray) const {
    double nearest = kNever;
    for (const Shape& shape : shapes) nearest = std::min(nearest, shape(origin, ray));
    return nearest;
  }
};

/// Scans of 64 beams with 0.2 degrees between firings, from several positions of a vehicle.
map::StaticMap scan(const Place& place, int scans) {
  map::StaticMap map;
  for (int index = 0; index < scans; ++index)
    for (int beam = 0; beam < 64; ++beam)
      for (int firing = -180; firing <= 180; ++firing) {
        const Vector3d eye(-0.8 * index, 0, 0.1);
        const double up = (2 - beam * 26.8 / 63) * std::numbers::pi / 180;
        const double left = (firing + 0.37 * index) * 0.2 * std::numbers::pi / 180;
        const Vector3d ray(std::cos(up) * std::cos(left), std::cos(up) * std::sin(left), std::sin(up));
        const double range = place.distance(eye, ray);
        if (range > 100) continue;
        const Vector3d p = eye + range * ray;
        add(map, p.x(), p.y(), p.z());
      }
  finish(map);
  return map;
}

View view() {
  View v = test_view();
  v.camera = {640, 400, 500, 500, 319.5, 199.5, {}};
  return v;
}

/// The exact depth of some pixels, and of a row above and below them.
cv::Mat1d truth(const Place& place, const View& of, const cv::Rect& pixels) {
  cv::Mat1d z(of.camera.height, of.camera.width, 0.0);
  for (int y = pixels.y - 1; y <= pixels.br().y; ++y)
    for (int x = pixels.x; x < pixels.br().x; ++x)
      z(y, x) = place.distance(Vector3d::Zero(), of.camera_from_world.R.transpose() * of.camera.ray({x, y}));
  return z;
}

const Shape kGround = plane({0, 0, -1.6}, {0, 0, 1}), kFacade = plane({28, 0, 0}, {-1, 0, 0});

/// Counts the pixels whose depth is not one of `expected`, up to a share of it or a displacement of one row.
int count_wrong(const DepthMap& depth, const std::vector<cv::Mat1d>& expected, const cv::Rect& pixels, double share) {
  int count = 0;
  for (int y = pixels.y; y < pixels.br().y; ++y)
    for (int x = pixels.x; x < pixels.br().x; ++x)
      count += std::none_of(expected.begin(), expected.end(), [&](const cv::Mat1d& z) {
        return std::abs(depth.z(y, x) / z(y, x) - 1) < share || std::abs(depth.z(y, x) / z(y - 1, x) - 1) < share ||
               std::abs(depth.z(y, x) / z(y + 1, x) - 1) < share;
      });
  return count;
}

}  // namespace

class PoleDepth : public testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(PoleDepth, HasTheWidthOfThePoleAndNoIntermediateValues) {
  const auto [distance, scans] = GetParam();
  const Place street{{kGround, kFacade}}, place{{kGround, kFacade, pole(distance, 0.013, 0.1, 5)}};
  const View of = view();
  const DepthMap depth = compute_depth_map(scan(place, scans), of, {});
  const int last = cvFloor(of.camera.cy + 1.6 * of.camera.fy / (1.1 * distance));  // below, the ground is as near
  const double half = of.camera.fx * std::tan(std::asin(0.1 / distance)),
               middle = of.camera.cx - of.camera.fx * 0.013 / distance;
  constexpr double kMaxErrorPx = 1 + 0.5;  // the surface ends at whole pixels
  for (int y = 190; y < last; ++y) {
    int left = 640, right = -1;
    for (int x = 290; x < 350; ++x) {
      if (depth.z(y, x) > 1.05 * distance) continue;
      EXPECT_NEAR(depth.z(y, x) / (distance - 0.05), 1, 0.01) << x << " " << y;
      left = std::min(left, x);
      right = std::max(right, x);
    }
    EXPECT_NEAR(left - 0.5, middle - half, kMaxErrorPx) << "row " << y;
    EXPECT_NEAR(right + 0.5, middle + half, kMaxErrorPx) << "row " << y;
  }
  const cv::Rect area(290, 190, 60, last - 190);
  const cv::Mat1d pole_depth(depth.z.size(), distance - 0.05);
  EXPECT_EQ(count_wrong(depth, {truth(street, of, area), pole_depth}, area, 0.03), 0);
}

INSTANTIATE_TEST_SUITE_P(Depth, PoleDepth, testing::Combine(testing::Values(8.0, 12.0, 20.0), testing::Values(1, 4)));

class RingDepth : public testing::TestWithParam<int> {};

TEST_P(RingDepth, IsThatOfAWireOrOfItsBackground) {
  const Place street{{kGround, kFacade}}, place{{kGround, kFacade, pole(10, 0, 0.01, 5)}};  // at most one return per ring
  const View of = view();
  const DepthMap depth = compute_depth_map(scan(place, GetParam()), of, {});
  const cv::Rect area(290, 190, 60, 70);
  const cv::Mat1d wire(depth.z.size(), 10.0);
  EXPECT_EQ(count_wrong(depth, {truth(street, of, area), wire}, area, 0.03), 0);
  for (int y = 190; y < 260; ++y) {
    int wide = 0;
    for (int x = 290; x < 350; ++x) wide += depth.z(y, x) < 10.5 ? 1 : 0;
    EXPECT_LE(wide, 3) << "row " << y;
  }
}

TEST_P(RingDepth, IsThatOfARailingOrOfItsBackground) {
  const Shape rail = plane({12, 0, 0}, {-1, 0, 0}, [](const Vector3d& p) {
    const double from_post = p.y() - 0.5 * std::round(2 * p.y());
    return p.z() < -0.6 && (p.z() > -0.66 || std::abs(from_post) < 0.015);
  });
  const Place street{{kGround, kFacade}}, place{{kGround, kFacade, rail}};
  const View of = view();
  const DepthMap depth = compute_depth_map(scan(place, GetParam()), of, {});
  const cv::Rect area(200, 190, 240, 60);
  const cv::Mat1d railing(depth.z.size(), 12.0);
  EXPECT_LT(count_wrong(depth, {truth(street, of, area), railing}, area, 0.03), 0.01 * area.area());
}

TEST_P(RingDepth, IsExactAtCornersOfBuildings) {
  for (const int sign : {1, -1}) {  // a convex corner and a concave one
    const Vector3d corner(20, 0, 0);
    const Place place{{kGround, plane(corner, {-1, 0.7 * sign, 0}, [](const Vector3d& p) { return p.y() >= 0; }),
                       plane(corner, {-1, -0.9 * sign, 0}, [](const Vector3d& p) { return p.y() < 0; })}};
    const View of = view();
    const cv::Rect area(200, 190, 240, 150);
    const DepthMap depth = compute_depth_map(scan(place, GetParam()), of, {});
    EXPECT_EQ(count_wrong(depth, {truth(place, of, area)}, area, 0.02), 0) << sign;
  }
}

TEST_P(RingDepth, IsExactOnSlantedGround) {
  const Place place{{plane({0, 0, -1.6}, {0.04, -0.06, 1})}};
  const View of = view();
  const cv::Rect area(150, 240, 340, 120);
  const DepthMap depth = compute_depth_map(scan(place, GetParam()), of, {});
  EXPECT_EQ(count_wrong(depth, {truth(place, of, area)}, area, 0.005), 0);
}

INSTANTIATE_TEST_SUITE_P(Depth, RingDepth, testing::Values(1, 4));

}  // namespace dvi::depth
