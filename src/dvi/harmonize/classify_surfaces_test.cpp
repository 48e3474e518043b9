#include "dvi/harmonize/classify_surfaces.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/harmonize/surface_class.h"
#include "dvi/image/region.h"
#include "dvi/testing/level_road.h"

namespace dvi::harmonize {
namespace {

/// A level road that ends at a wall 30 m ahead of the first camera, and a trunk at 8 m.
struct RoadWithWall : LevelRoad {
  depth::DepthMap depth{cv::Mat1f(kRows, kColumns, 0.0F), cv::Mat1f(kRows, kColumns, 0.05F)};
  cv::Mat1b truth = cv::Mat1b(kRows, kColumns, static_cast<uchar>(SurfaceClass::upright));
  static constexpr double kWall = 30, kTrunk = 8;
  static constexpr int kTrunkFrom = 200, kTrunkTo = 215;  // columns

  RoadWithWall() {
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x) {
        const double fall = descent(y), ahead = x >= kTrunkFrom && x < kTrunkTo ? kTrunk : kWall;
        const bool ground = fall > 0 && kCameraHeightM / fall < ahead;
        depth.z(y, x) = static_cast<float>(ground ? kCameraHeightM / fall : ahead);
        if (kCameraHeightM - depth.z(y, x) * fall < 0.35) truth(y, x) = static_cast<uchar>(SurfaceClass::ground);
      }
  }

  /// A hole that no source observed.
  cv::Mat1b classes(const cv::Rect& hole) const {
    cv::Mat1b mask(kRows, kColumns, uchar{0});
    mask(hole) = 255;
    const sample::Candidates candidates{Region(mask), std::vector<sample::Candidate>(hole.area())};
    const Views all = memory();
    return classify_surfaces({all, 0, depth, {}}, candidates, ground::RoadGround(map, all));
  }
  int count_wrong(const cv::Mat1b& found, const cv::Rect& where) const {
    return cv::countNonZero(cv::Mat1b(found(where)) != truth(where));
  }
};

TEST(ClassifySurfaces, FollowsTheDepth) {
  const RoadWithWall street;
  const cv::Rect hole(100, 20, 150, 80), surroundings(80, 0, 190, LevelRoad::kRows);
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

// Vehicles ahead hide the road; upright surfaces at both sides of the lane do not close it.
TEST(ClassifySurfaces, ContinuesTheLaneBetweenUprightSurfaces) {
  RoadWithWall street;
  const cv::Rect hole(110, 41, 80, 12);  // the foot of the wall
  street.depth.z(hole) = depth::DepthMap::kUnknown;
  const cv::Mat1b found = street.classes(hole);
  EXPECT_EQ(found(48, 159), static_cast<uchar>(SurfaceClass::ground)) << "47 m ahead in the lane";
  EXPECT_EQ(found(43, 159), static_cast<uchar>(SurfaceClass::ground)) << "114 m ahead";
  EXPECT_EQ(found(48, 115), static_cast<uchar>(SurfaceClass::upright)) << "beside the lane";
  street.depth.z(hole) = 30.0F;  // observed
  EXPECT_EQ(street.classes(hole)(48, 159), static_cast<uchar>(SurfaceClass::upright));
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
  const cv::Rect hole(180, 30, 20, 50);  // from the lane up to the trunk
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
