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

std::vector<View> bend() {
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

RoadFrame road_of(const std::vector<View>& views) {
  return RoadFrame(memory_views(views, std::vector<cv::Mat3b>(views.size()), std::vector<cv::Mat1b>(views.size())));
}

TEST(Road, FindsPlacesAgainInABend) {
  const RoadFrame road = road_of(bend());
  for (double along = 5; along < road.length() - 5; along += 3.7)
    for (const double left : {-9.0, -1.5, 0.0, 4.0, 9.0}) {
      const auto found = road.locate(road.place(along, left));
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->x(), along, 0.05);
      EXPECT_NEAR(found->y(), left, 0.05);
    }
  EXPECT_FALSE(road.locate({-500, 800}));
}

TEST(Road, LocatesAtTheNearestOfItsMeters) {
  const RoadFrame road = road_of(bend());
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d place(random.uniform(-60, 90), random.uniform(-30, 90));
    double least = RoadFrame::kReach;
    for (int k = 0; k <= road.length(); ++k) least = std::min(least, (road.place(k, 0) - place).norm());
    const auto found = road.locate(place);
    ASSERT_EQ(found.has_value(), least < RoadFrame::kReach) << place.transpose();
    if (!found) continue;
    EXPECT_NEAR(std::abs(found->y()), least, 0.6);  // its meters are half a meter away at most
  }
}

TEST(Road, ConsistsOfPiecesWherePosesJump) {
  std::vector<View> views = bend();
  const double whole = road_of(views).length();
  View far = views.back();
  far.camera_from_world = far.camera_from_world * SE3{Eigen::Matrix3d::Identity(), {-4e6, 0, 0}};
  views.push_back(far);
  const RoadFrame road = road_of(views);
  EXPECT_LT(road.length(), whole + 2 * RoadFrame::kOnward + 3);
  for (const View& view : views) {
    const Eigen::Vector2d place = view.camera_from_world.inverse().t.head<2>();
    const auto found = road.locate(place);
    ASSERT_TRUE(found);
    EXPECT_LT((road.place(found->x(), found->y()) - place).norm(), 0.01);
  }
}

}  // namespace
}  // namespace dvi::ground
