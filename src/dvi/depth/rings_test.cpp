#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "dvi/depth/depth.h"
#include "dvi/depth/test_map.h"

// What a LiDAR of 64 beams scans of exact shapes, against the depth of the same shapes at each pixel.

namespace dvi::depth {
namespace {

using Eigen::Vector3d;

/// How far along `ray` from `origin` it is to a surface.
using Shape = std::function<double(const Vector3d& origin, const Vector3d& ray)>;
constexpr double kNever = std::numeric_limits<double>::infinity();

Shape plane(const Vector3d& point, const Vector3d& normal) {
  return [=](const Vector3d& origin, const Vector3d& ray) {
    const double way = normal.dot(point - origin) / normal.dot(ray);
    return way > 0 ? way : kNever;
  };
}

/// Part of a plane.
Shape plane(const Vector3d& point, const Vector3d& normal, const std::function<bool(const Vector3d&)>& part) {
  return [=, whole = plane(point, normal)](const Vector3d& origin, const Vector3d& ray) {
    const double way = whole(origin, ray);
    return way < kNever && part(origin + way * ray) ? way : kNever;
  };
}

/// An upright cylinder.
Shape pole(double x, double y, double radius, double top) {
  return [=](const Vector3d& origin, const Vector3d& ray) {
    const Eigen::Vector2d o(origin.x() - x, origin.y() - y), r = ray.head<2>();
    const double a = r.squaredNorm(), b = o.dot(r), root = b * b - a * (o.squaredNorm() - radius * radius);
    if (root < 0) return kNever;
    const double way = (-b - std::sqrt(root)) / a;
    return way > 0 && origin.z() + way * ray.z() < top ? way : kNever;
  };
}

struct Place {
  std::vector<Shape> shapes;

  double way(const Vector3d& origin, const Vector3d& ray) const {
    double nearest = kNever;
    for (const Shape& shape : shapes) nearest = std::min(nearest, shape(origin, ray));
    return nearest;
  }
};

/// Rings of 64 beams, 0.2 degrees between firings, from some places on the way of a car.
map::StaticMap scan(const Place& place, int scans) {
  map::StaticMap map;
  for (int index = 0; index < scans; ++index)
    for (int beam = 0; beam < 64; ++beam)
      for (int firing = -180; firing <= 180; ++firing) {
        const Vector3d eye(-0.8 * index, 0, 0.1);
        const double up = (2 - beam * 26.8 / 63) * std::numbers::pi / 180;
        const double left = (firing + 0.37 * index) * 0.2 * std::numbers::pi / 180;
        const Vector3d ray(std::cos(up) * std::cos(left), std::cos(up) * std::sin(left), std::sin(up));
        const double way = place.way(eye, ray);
        if (way > 100) continue;
        const Vector3d p = eye + way * ray;
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

/// Depth along the optical axis of some pixels and a row above and below.
cv::Mat1d truth(const Place& place, const View& of, const cv::Rect& pixels) {
  cv::Mat1d z(of.camera.height, of.camera.width, 0.0);
  for (int y = pixels.y - 1; y <= pixels.br().y; ++y)
    for (int x = pixels.x; x < pixels.br().x; ++x)
      z(y, x) = place.way(Vector3d::Zero(), of.camera_from_world.R.transpose() * of.camera.ray({x, y}));
  return z;
}

const Shape kGround = plane({0, 0, -1.6}, {0, 0, 1}), kFacade = plane({28, 0, 0}, {-1, 0, 0});

/// How many pixels show none of `places`, within `share` of the depth there or a row above or below.
int wrong(const DepthMap& depth, const std::vector<cv::Mat1d>& places, const cv::Rect& pixels, double share) {
  int count = 0;
  for (int y = pixels.y; y < pixels.br().y; ++y)
    for (int x = pixels.x; x < pixels.br().x; ++x)
      count += std::none_of(places.begin(), places.end(), [&](const cv::Mat1d& z) {
        return std::abs(depth.z(y, x) / z(y, x) - 1) < share || std::abs(depth.z(y, x) / z(y - 1, x) - 1) < share ||
               std::abs(depth.z(y, x) / z(y + 1, x) - 1) < share;
      });
  return count;
}

}  // namespace

class Poles : public testing::TestWithParam<std::tuple<double, int>> {};

TEST_P(Poles, KeepTheirWidthAndLeaveNothingBetween) {
  const auto [distance, scans] = GetParam();
  const Place street{{kGround, kFacade}}, place{{kGround, kFacade, pole(distance, 0.013, 0.1, 5)}};
  const View of = view();
  const DepthMap depth = depth_map(scan(place, scans), of, {});
  const int last = cvFloor(of.camera.cy + 1.6 * of.camera.fy / (1.1 * distance));  // farther down the ground is as near
  const double half = of.camera.fx * std::tan(std::asin(0.1 / distance)),
               middle = of.camera.cx - of.camera.fx * 0.013 / distance;
  constexpr double kPixel = 1 + 0.5;  // the surface ends at whole pixels
  for (int y = 190; y < last; ++y) {
    int left = 640, right = -1;
    for (int x = 290; x < 350; ++x) {
      if (depth.z(y, x) > 1.05 * distance) continue;
      EXPECT_NEAR(depth.z(y, x) / (distance - 0.05), 1, 0.01) << x << " " << y;
      left = std::min(left, x);
      right = std::max(right, x);
    }
    EXPECT_NEAR(left - 0.5, middle - half, kPixel) << "row " << y;
    EXPECT_NEAR(right + 0.5, middle + half, kPixel) << "row " << y;
  }
  const cv::Rect round(290, 190, 60, last - 190);
  const cv::Mat1d pole_depth(depth.z.size(), distance - 0.05);
  EXPECT_EQ(wrong(depth, {truth(street, of, round), pole_depth}, round, 0.03), 0);
}

INSTANTIATE_TEST_SUITE_P(Depth, Poles, testing::Combine(testing::Values(8.0, 12.0, 20.0), testing::Values(1, 4)));

class RingsOf64Beams : public testing::TestWithParam<int> {};

TEST_P(RingsOf64Beams, ShowAWireOrWhatIsBehindIt) {
  const Place street{{kGround, kFacade}}, place{{kGround, kFacade, pole(10, 0, 0.01, 5)}};  // one firing a ring may meet it
  const View of = view();
  const DepthMap depth = depth_map(scan(place, GetParam()), of, {});
  const cv::Rect round(290, 190, 60, 70);
  const cv::Mat1d wire(depth.z.size(), 10.0);
  EXPECT_EQ(wrong(depth, {truth(street, of, round), wire}, round, 0.03), 0);
  for (int y = 190; y < 260; ++y) {
    int wide = 0;
    for (int x = 290; x < 350; ++x) wide += depth.z(y, x) < 10.5 ? 1 : 0;
    EXPECT_LE(wide, 3) << "row " << y;
  }
}

TEST_P(RingsOf64Beams, ShowARailingOrWhatIsBehindIt) {
  const Shape rail = plane({12, 0, 0}, {-1, 0, 0}, [](const Vector3d& p) {
    const double from_post = p.y() - 0.5 * std::round(2 * p.y());
    return p.z() < -0.6 && (p.z() > -0.66 || std::abs(from_post) < 0.015);
  });
  const Place street{{kGround, kFacade}}, place{{kGround, kFacade, rail}};
  const View of = view();
  const DepthMap depth = depth_map(scan(place, GetParam()), of, {});
  const cv::Rect round(200, 190, 240, 60);
  const cv::Mat1d railing(depth.z.size(), 12.0);
  EXPECT_LT(wrong(depth, {truth(street, of, round), railing}, round, 0.03), 0.01 * round.area());
}

TEST_P(RingsOf64Beams, MeetAtTheCornersOfHouses) {
  for (const int sign : {1, -1}) {  // a corner that points at the view, and one that encloses it
    const Vector3d corner(20, 0, 0);
    const Place place{{kGround, plane(corner, {-1, 0.7 * sign, 0}, [](const Vector3d& p) { return p.y() >= 0; }),
                       plane(corner, {-1, -0.9 * sign, 0}, [](const Vector3d& p) { return p.y() < 0; })}};
    const View of = view();
    const cv::Rect round(200, 190, 240, 150);
    const DepthMap depth = depth_map(scan(place, GetParam()), of, {});
    EXPECT_EQ(wrong(depth, {truth(place, of, round)}, round, 0.02), 0) << sign;
  }
}

TEST_P(RingsOf64Beams, LieOnGroundThatSlants) {
  const Place place{{plane({0, 0, -1.6}, {0.04, -0.06, 1})}};
  const View of = view();
  const cv::Rect round(150, 240, 340, 120);
  const DepthMap depth = depth_map(scan(place, GetParam()), of, {});
  EXPECT_EQ(wrong(depth, {truth(place, of, round)}, round, 0.005), 0);
}

INSTANTIATE_TEST_SUITE_P(Depth, RingsOf64Beams, testing::Values(1, 4));

}  // namespace dvi::depth
