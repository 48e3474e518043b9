#include "dvi/objects/label_masks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"

namespace dvi::objects {
namespace {

const MaskOptions kNoMargin{.dilate_px = 0, .box_margin_m = 0, .footprint_margin_m = 0};

// A camera that looks along the LiDAR's x axis.
Drive test_drive() {
  Drive drive;
  drive.path = "a-drive";
  drive.camera = {200, 100, 100, 100, 99.5, 49.5, {}};
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  drive.frames.resize(2);
  return drive;
}

Label boxed(double x, double y, double z) {
  Label label;
  label.box = Box{{Eigen::Matrix3d::Identity(), {x, y, z}}, {4, 2, 1}};
  return label;
}

TEST(LabelMasks, DrawTheConvexHullOfAProjectedBox) {
  const Drive drive = test_drive();
  const cv::Mat1b mask = draw_label(boxed(12, 0, 0), drive.camera, drive.camera_from_lidar, kNoMargin);
  // The near face, at 10 m, spans 2 m x 1 m: 20 px x 10 px around the center.
  EXPECT_EQ(mask(49, 99), 255);
  EXPECT_EQ(mask(49, 91), 255);
  EXPECT_EQ(mask(49, 87), 0);
  EXPECT_EQ(mask(56, 99), 0);
  EXPECT_NEAR(cv::countNonZero(mask), 200, 45);
}

TEST(LabelMasks, GrowWithTheMarginOfTheBox) {
  const Drive drive = test_drive();
  const int plain = cv::countNonZero(draw_label(boxed(12, 0, 0), drive.camera, drive.camera_from_lidar, kNoMargin));
  const int grown = cv::countNonZero(draw_label(boxed(12, 0, 0), drive.camera, drive.camera_from_lidar, {.box_margin_m = 0.5}));
  EXPECT_GT(grown, 1.5 * plain);
}

TEST(LabelMasks, ClipABoxAtTheNearPlane) {
  const Drive drive = test_drive();
  const cv::Mat1b beside = draw_label(boxed(1, 2, 0), drive.camera, drive.camera_from_lidar, kNoMargin);
  EXPECT_GT(cv::countNonZero(beside), 0);
  EXPECT_EQ(beside(49, 199), 0) << "a box to the left leaves the right side alone";
  EXPECT_EQ(cv::countNonZero(draw_label(boxed(-10, 0, 0), drive.camera, drive.camera_from_lidar, kNoMargin)), 0) << "behind";
}

TEST(LabelMasks, DecodeColumnMajorRuns) {
  Drive drive = test_drive();
  Label label;
  label.instance = Instance{{200, 100}, {3 * 100 + 10, 5, 95, 5}};  // rows 10..14 of columns 3 and 4
  const cv::Mat1b mask = draw_label(label, drive.camera, drive.camera_from_lidar, kNoMargin);
  EXPECT_EQ(cv::countNonZero(mask), 10);
  EXPECT_EQ(mask(10, 3), 255);
  EXPECT_EQ(mask(14, 4), 255);
  EXPECT_EQ(mask(15, 4), 0);
}

TEST(LabelMasks, AddTheGroundBelowTheBoxToAnOutline) {
  const Drive drive = test_drive();
  Label label = boxed(12, 0, -1);  // its bottom, 1.5 m down, spans rows 60 (14 m) to 64.5 (10 m)
  label.instance = Instance{{200, 100}, {100 * 100}};
  const cv::Mat1b mask = draw_label(label, drive.camera, drive.camera_from_lidar, kNoMargin);
  EXPECT_EQ(mask(62, 99), 255);
  EXPECT_EQ(mask(55, 99), 0) << "the box's own hull does not count";
  const cv::Mat1b wider = draw_label(label, drive.camera, drive.camera_from_lidar, {.footprint_margin_m = 0.5});
  EXPECT_GT(cv::countNonZero(wider), cv::countNonZero(mask));
}

TEST(LabelMasks, ClipARectangleToTheImage) {
  const Drive drive = test_drive();
  Label label;
  label.rect = cv::Rect2d(-20, 90, 30, 50);
  EXPECT_EQ(cv::countNonZero(draw_label(label, drive.camera, drive.camera_from_lidar, kNoMargin)), 10 * 10);
  label.rect = cv::Rect2d(-1e300, -1e300, 2e300, 2e300);
  EXPECT_EQ(cv::countNonZero(draw_label(label, drive.camera, drive.camera_from_lidar, kNoMargin)), 200 * 100);
}

TEST(LabelMasks, CoverTheImageWithAHugeBoxThroughAnyLens) {
  Drive drive = test_drive();
  drive.camera.distortion = {1e300, 0, 0, 0, -1e300};  // inf - inf
  Label label = boxed(12, 0, 0);
  label.box->size = {4, 1e60, 1e60};
  EXPECT_EQ(cv::countNonZero(draw_label(label, drive.camera, drive.camera_from_lidar, kNoMargin)), 200 * 100);
}

TEST(LabelMasks, UniteAndDilateTheLabelsOfAFrame) {
  Drive drive = test_drive();
  Label a, b;
  a.rect = cv::Rect2d(20, 20, 10, 10);
  b.rect = cv::Rect2d(100, 20, 10, 10);
  drive.frames[1].labels = {a, b};
  const Lazy<cv::Mat1b> masks = draw_label_masks(drive, {MaskSource::labels}, shared(drive.labels()), {.dilate_px = 2});
  EXPECT_EQ(cv::countNonZero(*masks[0]), 0);
  EXPECT_EQ((*masks[1])(25, 18), 255);
  EXPECT_EQ((*masks[1])(25, 17), 0);
  EXPECT_EQ((*masks[1])(25, 111), 255);
}

TEST(LabelMasks, ThrowIfTheSourceIsMissing) {
  const Drive drive = test_drive();
  EXPECT_THROW(draw_label_masks(drive, {MaskSource::labels}, {}, {}), InputError);
  EXPECT_THROW(draw_label_masks(drive, {MaskSource::files}, {}, {}), InputError);
}

}  // namespace
}  // namespace dvi::objects
