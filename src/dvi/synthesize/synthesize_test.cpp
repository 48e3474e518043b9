#include "dvi/synthesize/synthesize.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/ground/road_ground.h"
#include "dvi/image/region.h"
#include "dvi/map/static_map.h"
#include "dvi/testing/memory_views.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

constexpr double kHeight = 1.6;  // meters of the camera above the ground
constexpr int kViews = 16;

View looking_ahead(double x) {
  View view;
  view.camera = {320, 120, 250, 250, 159.5, 39.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  view.camera_from_world.t = -(view.camera_from_world.R * Eigen::Vector3d(x, 0, 0));
  return view;
}

/// A road with stripes along it, and images of it every 1 m.
struct Street {
  std::vector<View> views;
  std::vector<cv::Mat3b> images;
  std::vector<cv::Mat1b> masks;
  map::StaticMap map;

  /// Whether a parked car covers a point of the world.
  static bool is_parked_car(double x, double y) { return x > 14 && x < 18 && y > -3 && y < 0.5; }
  static uchar color(double y) { return std::fmod(std::abs(y), 1.0) < 0.5 ? 90 : 130; }

  Street() {
    for (int i = 0; i < kViews; ++i) {
      views.push_back(looking_ahead(i));
      images.emplace_back(120, 320, cv::Vec3b(200, 200, 200));
      masks.emplace_back(120, 320, uchar{0});
      paint(views.back(), images.back(), masks.back());
    }
    for (double x = -20; x < 60; x += 0.5)
      for (double y = -12; y < 12; y += 0.5) {
        map::MapPoint point;
        point.position = Eigen::Vector3d(x, y, -kHeight).cast<float>();
        point.normal = Eigen::Vector3f::UnitZ();
        map.points.push_back(point);
      }
  }

  static void paint(const View& view, cv::Mat3b& image, cv::Mat1b& mask) {
    const SE3 world_from_camera = view.camera_from_world.inverse();
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray({u, v});
        if (ray.z() >= -0.03) continue;
        const Eigen::Vector3d x = world_from_camera.t - kHeight / ray.z() * ray;
        image(v, u) = cv::Vec3b::all(color(x.y()));
        if (is_parked_car(x.x(), x.y())) mask(v, u) = 255;
      }
  }

  depth::DepthMap depth() const { return {cv::Mat1f(120, 320, 0.0F), cv::Mat1f(120, 320, 0.0F)}; }

  /// View 8, with its hole interpolated as gray.
  harmonize::FilledFrame interpolated() const {
    harmonize::FilledFrame frame;
    images[8].convertTo(frame.color, CV_32F);
    frame.mask = masks[8].clone();
    frame.kind = cv::Mat1b(masks[8] / 255 * static_cast<uchar>(Kind::interpolated));
    frame.confidence = cv::Mat1b(~masks[8]);
    frame.depth = depth().z;
    frame.color.setTo(cv::Scalar::all(110), frame.mask);
    return frame;
  }
  harmonize::FilledFrame run(const harmonize::FilledFrame& frame) const {
    const Views all = memory_views(views, images, masks);
    const Lazy<depth::VisibilityMap> visibility(
        views.size(), [&](std::size_t i) { return depth::make_visibility_map(depth(), *all.masks[i]); });
    return synthesize(frame, all[8], {}, {RoadTexture(ground::RoadGround(map, all), all, visibility), NoiseTexture(all)});
  }
};

double mean_error(const cv::Mat3f& image, const cv::Mat3b& truth, const cv::Mat1b& where) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (where(y, x) != 0) {
        sum += std::abs(image(y, x)[1] - static_cast<float>(truth(y, x)[1]));
        ++count;
      }
  return count > 0 ? sum / count : 0;
}

cv::Mat1f gray_of(const cv::Mat3f& color) {
  cv::Mat1f out;
  cv::extractChannel(color, out, 1);
  return out;
}

TEST(Synthesize, StripesOfTheRoadContinueUnderAParkedCar) {
  const Street street;
  const harmonize::FilledFrame before = street.interpolated(), after = street.run(before);
  const cv::Mat1b hole = before.mask;
  ASSERT_GT(cv::countNonZero(hole), 500);
  EXPECT_EQ(cv::countNonZero(cv::Mat1b(after.kind == static_cast<uchar>(Kind::synthesized)) != hole), 0);
  EXPECT_LT(mean_error(after.color, street.images[8], hole), 0.7 * mean_error(before.color, street.images[8], hole));
  const cv::Mat1b outside(~hole);
  EXPECT_EQ(mean_error(after.color, street.images[8], outside), 0);
}

TEST(Synthesize, ContrastIsProportionalToBrightness) {
  const Street street;
  harmonize::FilledFrame frame = street.interpolated();
  frame.color = cv::Mat3f(0.25 * frame.color);
  const harmonize::FilledFrame after = street.run(frame);
  cv::Scalar mean, deviation, lit_deviation;
  cv::meanStdDev(after.color, mean, deviation, frame.mask);
  cv::meanStdDev(street.run(street.interpolated()).color, mean, lit_deviation, frame.mask);
  EXPECT_NEAR(deviation[1] / lit_deviation[1], 0.25, 0.1);
}

TEST(Synthesize, IsWithinTheColorsAroundTheHole) {
  const Street street;
  const harmonize::FilledFrame frame = street.interpolated();
  cv::Mat1b boundary;
  cv::dilate(frame.mask, boundary, cv::Mat1b(17, 17, uchar{1}));
  boundary &= ~frame.mask;
  harmonize::FilledFrame even = frame;
  even.color = frame.color.clone();
  even.color.setTo(cv::Scalar::all(105), boundary);
  even.color.setTo(cv::Scalar::all(115), cv::Mat1b(boundary & cv::Mat1b(gray_of(frame.color) > 110)));
  const harmonize::FilledFrame after = street.run(even);
  const cv::Mat1b near(grown(cv::Mat1b(~frame.mask), 3) & frame.mask);
  double low = 0, high = 0;
  cv::minMaxLoc(gray_of(after.color), &low, &high, nullptr, nullptr, near);
  EXPECT_GE(low, 105);
  EXPECT_LE(high, 115);
}

TEST(Synthesize, DoesNotChangeInterpolatedColorsThatAreNotNearby) {
  Street street;
  street.map.points.clear();
  harmonize::FilledFrame frame = street.interpolated();
  frame.color.setTo(cv::Scalar::all(110));
  frame.color.setTo(cv::Scalar::all(200), frame.mask);  // as of sky that begins inside the hole
  EXPECT_LT(cv::norm(frame.color, street.run(frame).color, cv::NORM_INF), 0.01);
}

TEST(Synthesize, ConfidenceDecreasesWithTheContrastAroundTheHole) {
  const Street street;
  harmonize::FilledFrame frame = street.interpolated();
  const cv::Mat1b hole = frame.mask;
  const double plain = cv::mean(street.run(frame).confidence, hole)[0];
  for (int y = 0; y < frame.color.rows; ++y)
    for (int x = 0; x < frame.color.cols; ++x)
      if (hole(y, x) == 0) frame.color(y, x) += cv::Vec3f::all((x + y) % 2 == 0 ? 30.0F : -30.0F);
  const double rough = cv::mean(street.run(frame).confidence, hole)[0];
  EXPECT_LT(rough, 0.5 * plain);
  EXPECT_GT(rough, 0);
  EXPECT_LT(plain, 255);
}

TEST(Synthesize, AddsNoNoiseToUniformSurroundingsWithoutGround) {
  Street street;
  street.map.points.clear();
  harmonize::FilledFrame before = street.interpolated();
  before.color.setTo(cv::Scalar::all(110));
  const harmonize::FilledFrame after = street.run(before);
  EXPECT_LT(cv::norm(before.color, after.color, cv::NORM_INF), 0.01);
  EXPECT_EQ(cv::countNonZero(cv::Mat1b(after.kind == static_cast<uchar>(Kind::synthesized)) != before.mask), 0);
}

TEST(Synthesize, NoiseFollowsTheSurroundingsWithoutGround) {
  Street street;
  street.map.points.clear();
  harmonize::FilledFrame frame = street.interpolated();
  for (int y = 0; y < frame.color.rows; ++y)
    for (int x = 0; x < frame.color.cols; ++x)
      if (frame.mask(y, x) == 0) frame.color(y, x) = cv::Vec3f::all((x / 2 + y / 2) % 2 == 0 ? 95.0F : 125.0F);
  const harmonize::FilledFrame after = street.run(frame);
  cv::Scalar mean, deviation;
  cv::meanStdDev(after.color, mean, deviation, frame.mask);
  EXPECT_GT(deviation[1], 3);
  EXPECT_LT(deviation[1], 15);
  EXPECT_NEAR(mean[1], 110, 2);
}

TEST(Synthesize, AHoleOfTheWholeFrameHasFiniteColors) {
  Street street;
  harmonize::FilledFrame frame = street.interpolated();
  frame.mask.setTo(255);
  frame.kind.setTo(static_cast<uchar>(Kind::interpolated));
  frame.color.setTo(cv::Scalar::all(255));
  const harmonize::FilledFrame after = street.run(frame);
  EXPECT_TRUE(cv::checkRange(after.color, true, nullptr, 0, 255.001));
}

TEST(Synthesize, DoesNotChangeAFrameWithoutAHole) {
  const Street street;
  harmonize::FilledFrame frame = street.interpolated();
  frame.kind.setTo(0);
  EXPECT_EQ(cv::norm(street.run(frame).color, frame.color, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::synthesize
