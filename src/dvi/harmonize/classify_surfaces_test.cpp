#include "dvi/harmonize/classify_surfaces.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/harmonize/surface_class.h"
#include "dvi/image/region.h"
#include "dvi/map/static_map.h"
#include "dvi/testing/memory_views.h"

namespace dvi::harmonize {
namespace {

constexpr double kCameraHeight = 1.6;  // meters of the camera above the ground
constexpr int kStreetColumns = 320, kStreetRows = 120;

/// A level road that ends at a wall 30 m ahead of the first camera, and a trunk at 8 m.
struct RoadWithWall {
  std::vector<View> views;
  map::StaticMap map;
  depth::DepthMap depth{cv::Mat1f(kStreetRows, kStreetColumns, 0.0F), cv::Mat1f(kStreetRows, kStreetColumns, 0.05F)};
  cv::Mat1b truth = cv::Mat1b(kStreetRows, kStreetColumns, static_cast<uchar>(SurfaceClass::upright));
  static constexpr double kWall = 30, kTrunk = 8;
  static constexpr int kTrunkFrom = 200, kTrunkTo = 215;  // columns

  RoadWithWall() {
    for (int i = 0; i < 12; ++i) {
      View view;
      view.camera = {kStreetColumns, kStreetRows, 250, 250, 159.5, 39.5, {}};
      view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
      view.camera_from_world.t = -(view.camera_from_world.R * Eigen::Vector3d(i, 0, 0));
      views.push_back(view);
    }
    for (double x = -20; x < 60; x += 0.5)
      for (double y = -12; y < 12; y += 0.5) {
        map::MapPoint point;
        point.position = Eigen::Vector3d(x, y, -kCameraHeight).cast<float>();
        point.normal = Eigen::Vector3f::UnitZ();
        map.points.push_back(point);
      }
    for (int y = 0; y < kStreetRows; ++y)
      for (int x = 0; x < kStreetColumns; ++x) {
        const double fall = (y - 39.5) / 250, ahead = x >= kTrunkFrom && x < kTrunkTo ? kTrunk : kWall;
        const bool ground = fall > 0 && kCameraHeight / fall < ahead;
        depth.z(y, x) = static_cast<float>(ground ? kCameraHeight / fall : ahead);
        if (kCameraHeight - depth.z(y, x) * fall < 0.35) truth(y, x) = static_cast<uchar>(SurfaceClass::ground);
      }
  }

  /// A hole that no source observed.
  cv::Mat1b classes(const cv::Rect& hole) const {
    cv::Mat1b mask(kStreetRows, kStreetColumns, uchar{0});
    mask(hole) = 255;
    const sample::Candidates candidates{Region(mask), std::vector<sample::Candidate>(hole.area())};
    const Views all = memory_views(views, std::vector<cv::Mat3b>(views.size()), std::vector<cv::Mat1b>(views.size()));
    return classify_surfaces({all, 0, depth, {}}, candidates, ground::RoadGround(map, all));
  }
  int count_wrong(const cv::Mat1b& found, const cv::Rect& where) const {
    return cv::countNonZero(cv::Mat1b(found(where)) != truth(where));
  }
};

TEST(ClassifySurfaces, FollowsTheDepth) {
  const RoadWithWall street;
  const cv::Rect hole(100, 20, 150, 80), surroundings(80, 0, 190, kStreetRows);
  EXPECT_LT(street.count_wrong(street.classes(hole), surroundings), surroundings.width) << "within a row";
  EXPECT_EQ(cv::countNonZero(street.classes(hole).colRange(0, 70)), 0) << "unknown far from the hole";
}

TEST(ClassifySurfaces, PropagatesClassesWhereDepthIsUnknown) {
  RoadWithWall street;
  const cv::Rect hole(60, 30, 80, 50);
  for (const float z : {depth::DepthMap::kUnknown, depth::DepthMap::kSky}) {
    street.depth.z(hole) = z;
    EXPECT_LT(street.count_wrong(street.classes(hole), hole), 2 * hole.width) << "within two rows";
  }
}

TEST(ClassifySurfaces, IgnoresUncertainDepth) {
  RoadWithWall street;
  const cv::Rect hole(60, 30, 80, 50);
  street.depth.z(hole) = 5.0F;  // as of an object in front of the wall
  EXPECT_GT(street.count_wrong(street.classes(hole), hole), hole.area() / 4);
  street.depth.sigma(hole) = 1.0F;
  EXPECT_LT(street.count_wrong(street.classes(hole), hole), 2 * hole.width);
}

TEST(ClassifySurfaces, DoesNotPropagateATrunkBesideTheHole) {
  RoadWithWall street;
  const cv::Rect hole(150, 30, 50, 50);  // up to the trunk
  street.depth.z(hole) = depth::DepthMap::kUnknown;
  EXPECT_LT(street.count_wrong(street.classes(hole), hole), 3 * hole.width);
}

TEST(ClassifySurfaces, IsUnknownWithoutGroundAndForDepthCameras) {
  RoadWithWall street;
  const cv::Rect hole(60, 30, 80, 50);
  for (View& view : street.views) view.sensor = Sensor::depth_camera;
  EXPECT_EQ(cv::countNonZero(street.classes(hole)), 0);
  for (View& view : street.views) view.sensor = Sensor::lidar;
  street.map.points.clear();
  EXPECT_EQ(cv::countNonZero(street.classes(hole)), 0);
}

}  // namespace
}  // namespace dvi::harmonize
