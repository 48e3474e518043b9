#include "dvi/synthesize/completed_views.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/testing/level_road.h"
#include "dvi/testing/memory_views.h"

namespace dvi::synthesize {
namespace {

const cv::Size kViewSize(320, 120);

Views drive(const std::vector<double>& positions) {
  std::vector<View> views;
  for (const double x : positions) views.push_back(looking_ahead(x));
  const std::size_t n = views.size();
  return memory_views(std::move(views), std::vector(n, cv::Mat3b(kViewSize, cv::Vec3b())),
                      std::vector(n, cv::Mat1b(kViewSize, uchar{0})));
}

/// A frame whose color depends on the place on the ground, and the guide that all of it is ground.
struct GroundFrame {
  explicit GroundFrame(const View& view) {
    frame.color = cv::Mat3f(kViewSize, cv::Vec3f());
    frame.kind = cv::Mat1b(kViewSize, uchar{0});
    frame.depth = cv::Mat1f(kViewSize, 0.0F);
    guide.group = cv::Mat1b(kViewSize, static_cast<uchar>(Group::ground));
    for (int y = 60; y < kViewSize.height; ++y)
      for (int x = 0; x < kViewSize.width; ++x) frame.color(y, x) = color_at(view, {x, y});
  }
  static cv::Vec3f color_at(const View& view, cv::Point p) {
    const SE3 world_from_camera = view.camera_from_world.inverse();
    const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray({p.x, p.y});
    const Eigen::Vector3d at = world_from_camera.t - kCameraHeightM / ray.z() * ray;
    return {static_cast<float>(100 + 40 * std::sin(at.x())), static_cast<float>(100 + 40 * std::sin(at.y())), 50};
  }
  harmonize::FilledFrame frame;
  SurfaceGuide guide;
};

cv::Mat1b below_horizon() {
  cv::Mat1b out(kViewSize, uchar{0});
  out(cv::Rect(0, 60, kViewSize.width, 60)).setTo(255);
  return out;
}

TEST(SelectViewsToComplete, StartsWithTheViewThatIsNearestToOthersSurfaces) {
  std::vector<double> positions;
  for (int i = 0; i < 21; ++i) positions.push_back(i);
  const std::vector<std::size_t> forward = select_views_to_complete(drive(positions));
  EXPECT_EQ(forward, (std::vector<std::size_t>{20, 15, 10, 5, 0}));
  const std::vector<std::size_t> backward = select_views_to_complete(drive({positions.rbegin(), positions.rend()}));
  EXPECT_EQ(backward, (std::vector<std::size_t>{0, 5, 10, 15, 20}));
}

TEST(SelectViewsToComplete, AStandingCameraHasTheFirstAndTheLast) {
  EXPECT_EQ(select_views_to_complete(drive({3, 3, 3, 3})), (std::vector<std::size_t>{3, 0}));
  EXPECT_EQ(select_views_to_complete(drive({3})), (std::vector<std::size_t>{0}));
}

TEST(CompletedViews, AreShownFromOtherPositions) {
  const Views views = drive({0, 1, 2, 3, 4, 5});
  const map::StaticMap map = make_level_map();
  const ground::RoadGround ground(map, views);
  ASSERT_TRUE(ground.found());
  const GroundFrame made(views[5]);
  const cv::Mat1b wanted = below_horizon();
  const CompletedView key = make_completed_view({made.frame, wanted, made.guide}, views, 5, ground);
  EXPECT_EQ(key.size(), static_cast<std::size_t>(cv::countNonZero(wanted)));
  const auto [shown, color] = show_completed_views({key}, views, views[3], wanted);
  EXPECT_GT(cv::countNonZero(shown), 5000);
  double error = 0;
  int count = 0;
  for (int y = 64; y < kViewSize.height; ++y)
    for (int x = 0; x < kViewSize.width; ++x) {
      if (shown(y, x) == 0) {
        EXPECT_EQ(color(y, x), cv::Vec3f());
        continue;
      }
      error += cv::norm(color(y, x) - GroundFrame::color_at(views[3], {x, y}));
      ++count;
    }
  EXPECT_LT(error / count, 4);
}

TEST(CompletedViews, AreShownInTheIlluminationOfTheView) {
  Views views = drive({0, 1});
  views.views[0].gain = {2, 2, 2};
  const map::StaticMap map = make_level_map();
  const ground::RoadGround ground(map, views);
  GroundFrame made(views[1]);
  made.frame.color.setTo(cv::Scalar::all(120));
  const CompletedView key = make_completed_view({made.frame, below_horizon(), made.guide}, views, 1, ground);
  const auto [shown, color] = show_completed_views({key}, views, views[0], below_horizon());
  EXPECT_NEAR(cv::mean(color, shown)[0], 60, 0.5);
}

TEST(CompletedViews, TheFirstOneCounts) {
  const Views views = drive({0, 1});
  const map::StaticMap map = make_level_map();
  const ground::RoadGround ground(map, views);
  GroundFrame dark(views[1]), bright(views[0]);
  dark.frame.color.setTo(cv::Scalar::all(20));
  bright.frame.color.setTo(cv::Scalar::all(220));
  const CompletedViews completed{make_completed_view({dark.frame, below_horizon(), dark.guide}, views, 1, ground),
                                 make_completed_view({bright.frame, below_horizon(), bright.guide}, views, 0, ground)};
  const cv::Mat3f color = show_completed_views(completed, views, views[0], below_horizon()).color;
  EXPECT_NEAR(color(80, 160)[0], 20, 1e-3);
  EXPECT_NEAR(color(118, 160)[0], 220, 1e-3);  // nearer than the first one shows
}

TEST(CompletedViews, UprightSurfacesAreAtTheirDepthOrAtThatOfTheirFeet) {
  const Views views = drive({0, 1});
  const map::StaticMap map = make_level_map();
  const ground::RoadGround ground(map, views);
  GroundFrame made(views[0]);
  made.guide.group(cv::Rect(0, 0, kViewSize.width, 80)).setTo(static_cast<uchar>(Group::upright));
  made.frame.depth(cv::Rect(0, 0, 100, 80)).setTo(7);
  cv::Mat1b completed(kViewSize, uchar{255});
  const CompletedView key = make_completed_view({made.frame, completed, made.guide}, views, 0, ground);
  const auto depth_at = [&](int x, int y) { return key.depths_m[static_cast<std::size_t>(y) * kViewSize.width + x]; };
  EXPECT_EQ(depth_at(50, 30), 7);
  EXPECT_NEAR(depth_at(200, 30), kCameraHeightM * 250 / (80 - 39.5), 0.3);
  EXPECT_NEAR(depth_at(200, 100), kCameraHeightM * 250 / (100 - 39.5), 0.1);
}

TEST(CompletedViews, NoneShowsNothing) {
  const Views views = drive({0});
  EXPECT_EQ(cv::countNonZero(show_completed_views({}, views, views[0], below_horizon()).shown), 0);
  EXPECT_EQ(cv::countNonZero(show_completed_views({CompletedView{}}, views, views[0], below_horizon()).shown), 0);
}

}  // namespace
}  // namespace dvi::synthesize
