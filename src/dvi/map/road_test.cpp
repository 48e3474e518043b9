#include "dvi/map/road.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/drive/memory_views.h"

namespace dvi::map {
namespace {

TEST(Road, FindsPlacesAgainInABend) {
  std::vector<View> views;
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.02 * i;
    View view;
    view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    view.camera_from_world.t =
        -(view.camera_from_world.R * Eigen::Vector3d(50 * std::sin(angle), 50 * (1 - std::cos(angle)), 0));
    views.push_back(view);
  }
  const Road road(memory_views(views, std::vector<cv::Mat3b>(60), std::vector<cv::Mat1b>(60)));
  for (double along = 5; along < road.length() - 5; along += 3.7)
    for (const double left : {-9.0, -1.5, 0.0, 4.0, 9.0}) {
      const auto found = road.locate(road.place(along, left));
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->x(), along, 0.05);
      EXPECT_NEAR(found->y(), left, 0.05);
    }
  EXPECT_FALSE(road.locate({-500, 800}));
}

}  // namespace
}  // namespace dvi::map
