#include "dvi/objects/reprojected_mask.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

constexpr double kBaseline = 0.5, kFocal = 200, kObject = 4, kWall = 40;  // meters, pixels, meters, meters
const cv::Rect kHidden(100, 40, 60, 40);                                  // the object in the first image
constexpr int kShiftOfObject = 25;                                        // pixels between the images: 200 x .5 / 4

/// Two cameras side by side before a wall, and an object that the mask of the first one covers.
struct Pair {
  RigCamera first{{320, 120, kFocal, kFocal, 160, 60, {}}, {}};
  RigCamera right = first;
  cv::Mat1b mask{cv::Mat1b(120, 320, uchar{0})};
  std::vector<Eigen::Vector3d> returns;

  /// `on_object` returns whether the object reflects the ray through a pixel of the first image. Other rays hit the wall.
  template <class OnObject>
  explicit Pair(OnObject on_object) {
    right.camera_from_world.t.x() = -kBaseline;
    mask(kHidden) = 255;
    for (int y = 0; y < 120; y += 3)
      for (int x = -40; x < 400; x += 2) {
        const bool hits = kHidden.contains({x, y}) && on_object(x, y);
        returns.push_back((hits ? kObject : kWall) * first.camera.ray({x, y}));
      }
  }

  cv::Mat1b reprojected() const { return reproject_mask(mask, first, right, returns); }
};

const cv::Rect kShown = kHidden - cv::Point(kShiftOfObject, 0);  // the object in the other image

TEST(ReprojectedMask, CoversTheObjectInTheOtherCamera) {
  const cv::Mat1b mask = Pair([](int, int) { return true; }).reprojected();
  EXPECT_EQ(cv::countNonZero(mask(kShown)), kShown.area());
}

TEST(ReprojectedMask, DoesNotCoverTheBackgroundBesideTheObject) {
  const cv::Mat1b mask = Pair([](int, int) { return true; }).reprojected();
  const cv::Rect past(kShown.br().x + 10, kHidden.y, 2, kHidden.height);  // up to 7 px before the wall's shift ends
  EXPECT_EQ(cv::countNonZero(mask(past)), 0);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(10, 8, 300, 20))), 0) << "far above";
}

TEST(ReprojectedMask, CoversObjectsWhoseGlassRaysPass) {
  const auto frame_only = [](int x, int y) { return x < 108 || x > 152 || y < 48 || y > 72; };
  const cv::Mat1b mask = Pair(frame_only).reprojected();
  EXPECT_EQ(cv::countNonZero(mask(kShown)), kShown.area());
}

TEST(ReprojectedMask, CoversAreasOutsideTheFirstImage) {
  Pair pair([](int, int) { return true; });
  pair.right.camera_from_world =
      SE3{so3_exp({0, -0.5, 0}), Eigen::Vector3d::Zero()} * pair.right.camera_from_world;  // looks farther to the right
  const cv::Mat1b mask = pair.reprojected();
  EXPECT_EQ(cv::countNonZero(mask.colRange(240, 320)), 80 * 120);
  EXPECT_EQ(mask(20, 60), 0);
}

TEST(ReprojectedMask, CoversTheImageWithoutReturns) {
  Pair pair([](int, int) { return true; });
  pair.returns.clear();
  EXPECT_EQ(cv::countNonZero(pair.reprojected()), 320 * 120);
}

}  // namespace
}  // namespace dvi::objects
