#include "dvi/ground/road_frame.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/random.h"
#include "dvi/testing/memory_views.h"

namespace dvi::ground {
namespace {

std::vector<View> make_curve() {
  std::vector<View> views;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.02 * i;
    View view;
    view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    view.camera_from_world.t =
        -(view.camera_from_world.R * Eigen::Vector3d(50 * std::sin(angle), 50 * (1 - std::cos(angle)), 0));
    views.push_back(view);
  }
  return views;
}

RoadFrame make_road(const std::vector<View>& views) {
  return RoadFrame(memory_views(views, std::vector<cv::Mat3b>(views.size()), std::vector<cv::Mat1b>(views.size())));
}

TEST(Road, LocatesPositionsInACurve) {
  const RoadFrame road = make_road(make_curve());
  for (double along = 5; along < road.length() - 5; along += 3.7)
    for (const double left : {-9.0, -1.5, 0.0, 4.0, 9.0}) {
      const auto found = road.locate(road.to_world(along, left));
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->x(), along, 0.05);
      EXPECT_NEAR(found->y(), left, 0.05);
    }
  EXPECT_FALSE(road.locate({-500, 800}));
}

TEST(Road, LocatesAtTheNearestPathPoint) {
  const RoadFrame road = make_road(make_curve());
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d position(random.uniform(-60, 90), random.uniform(-30, 90));
    double lowest = RoadFrame::kHalfWidthM;
    for (int k = 0; k <= road.length(); ++k) lowest = std::min(lowest, (road.to_world(k, 0) - position).norm());
    const auto found = road.locate(position);
    ASSERT_EQ(found.has_value(), lowest < RoadFrame::kHalfWidthM) << position.transpose();
    if (!found) continue;
    EXPECT_NEAR(std::abs(found->y()), lowest, 0.6);  // the nearest path point is at most half a meter away
  }
}

TEST(Road, HasPiecesIfPosesJump) {
  std::vector<View> views = make_curve();
  const double whole = make_road(views).length();
  View far = views.back();
  far.camera_from_world = far.camera_from_world * SE3{Eigen::Matrix3d::Identity(), {-4e6, 0, 0}};
  views.push_back(far);
  const RoadFrame road = make_road(views);
  EXPECT_LT(road.length(), whole + 2 * RoadFrame::kExtensionM + 3);
  for (const View& view : views) {
    const Eigen::Vector2d position = view.camera_from_world.inverse().t.head<2>();
    const auto found = road.locate(position);
    ASSERT_TRUE(found);
    EXPECT_LT((road.to_world(found->x(), found->y()) - position).norm(), 0.01);
  }
}

}  // namespace
}  // namespace dvi::ground
