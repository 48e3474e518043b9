#include "dvi/harmonize/road_colors.h"

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/drive/sensor.h"
#include "dvi/testing/level_road.h"

namespace dvi::harmonize {
namespace {

/// A level road with a gray lane between verges, which ends in trees 60 m ahead of the first camera.
struct RoadWithVerges : LevelRoad {
  static constexpr double kEnd = 60, kHalfRoad = 3;
  inline static const cv::Vec3f kTrees{20, 40, 20}, kLeft{30, 160, 40}, kRoad{120, 120, 120}, kRight{200, 210, 220};
  depth::DepthMap depth{cv::Mat1f(kRows, kColumns, 0.0F), cv::Mat1f(kRows, kColumns, 0.05F)};
  cv::Mat3f color = cv::Mat3f(kRows, kColumns, kTrees);
  cv::Mat1b known = cv::Mat1b(kRows, kColumns, uchar{255});

  RoadWithVerges() {
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        const double fall = descent(y);
        const bool ground = fall > 0 && kCameraHeightM / fall < kEnd;
        depth.z(y, x) = static_cast<float>(ground ? kCameraHeightM / fall : kEnd);
        if (!ground) continue;
        const double left_m = -depth.z(y, x) * (x - kCenterX) / kFocalPx;
        color(y, x) = left_m > kHalfRoad ? kLeft : left_m < -kHalfRoad ? kRight : kRoad;
      }
  }

  /// The color at a position on the ground in the first frame.
  std::optional<ColorPull> at(double ahead_m, double left_m) const {
    const Views all = memory();
    const ground::RoadGround ground(map, all);
    return RoadColors({all, 0, depth, {}}, ground, color, known)
        .at({cvRound(kCenterX - kFocalPx * left_m / ahead_m), row_at(ahead_m)});
  }
  static int row_at(double ahead_m) { return cvRound(kHorizonY + kFocalPx * kCameraHeightM / ahead_m); }
  /// Makes everything unknown from a distance on, as behind a vehicle that is as wide as the image.
  void hide_beyond(double ahead_m) { known.rowRange(0, row_at(ahead_m)) = uchar{0}; }
};

TEST(RoadColors, ContinueTheStripsOfTheGroundAlongTheRoad) {
  RoadWithVerges road;
  road.hide_beyond(15);
  for (const double ahead_m : {12.0, 20.0, 50.0, 100.0}) {
    const auto lane = road.at(ahead_m, 0);
    ASSERT_TRUE(lane) << ahead_m;
    EXPECT_LT(cv::norm(lane->color, RoadWithVerges::kRoad, cv::NORM_INF), 1) << ahead_m;
  }
  EXPECT_LT(cv::norm(road.at(20, 6)->color, RoadWithVerges::kLeft, cv::NORM_INF), 1);
  EXPECT_LT(cv::norm(road.at(20, -6)->color, RoadWithVerges::kRight, cv::NORM_INF), 1);
}

TEST(RoadColors, PullMoreInTheDistanceWhereTheRoadIsNarrow) {
  const RoadWithVerges road;
  EXPECT_GT(road.at(40, 0)->weight, 10 * road.at(10, 0)->weight);
}

TEST(RoadColors, TakeTheNearestColorAlongTheRoad) {
  RoadWithVerges road;
  for (int y = 0; y < LevelRoad::kRows; ++y)
    if (road.depth.z(y, 159) > 20) road.color.row(y).setTo(cv::Scalar(10, 10, 10));  // shade
  EXPECT_LT(cv::norm(road.at(40, 0)->color, cv::Vec3f::all(10), cv::NORM_INF), 15);
  EXPECT_LT(cv::norm(road.at(9, 0)->color, RoadWithVerges::kRoad, cv::NORM_INF), 45);
}

TEST(RoadColors, AreNotReadFromUprightSurfacesOrUncertainDepth) {
  RoadWithVerges road;
  road.hide_beyond(15);
  road.depth.z.setTo(5.0F, road.depth.z > 8);  // obstacles above the ground
  EXPECT_LT(cv::norm(road.at(20, 0)->color, RoadWithVerges::kRoad, cv::NORM_INF), 1);
  road.depth.sigma.setTo(1.0F);
  EXPECT_FALSE(road.at(20, 0));
}

TEST(RoadColors, AreNoneAboveTheHorizonBesideTheRoadAndWithoutGround) {
  RoadWithVerges road;
  EXPECT_FALSE(road.at(-20, 0)) << "above the horizon";
  EXPECT_FALSE(road.at(35, 22)) << "too far from the road";
  RoadWithVerges unmapped = road;
  unmapped.map.points.clear();
  EXPECT_FALSE(unmapped.at(20, 0));
  for (View& view : road.views) view.sensor = Sensor::depth_camera;
  EXPECT_FALSE(road.at(20, 0));
}

}  // namespace
}  // namespace dvi::harmonize
