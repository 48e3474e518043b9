#include "dvi/synthesize/synthesize.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/ground/road_ground.h"
#include "dvi/image/region.h"
#include "dvi/testing/level_road.h"
#include "dvi/testing/memory_views.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

constexpr int kViews = 16;

/// A road with stripes along it, and images of it every 1 m.
struct Street {
  std::vector<View> views;
  std::vector<cv::Mat3b> images;
  std::vector<cv::Mat1b> masks;
  map::StaticMap map = make_level_map();

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
  }

  static void paint(const View& view, cv::Mat3b& image, cv::Mat1b& mask) {
    const SE3 world_from_camera = view.camera_from_world.inverse();
    for (int v = 0; v < image.rows; ++v)
      for (int u = 0; u < image.cols; ++u) {
        const Eigen::Vector3d ray = world_from_camera.R * view.camera.ray({u, v});
        if (ray.z() >= -0.03) continue;
        const Eigen::Vector3d x = world_from_camera.t - kCameraHeightM / ray.z() * ray;
        image(v, u) = cv::Vec3b::all(color(x.y()));
        if (is_parked_car(x.x(), x.y())) mask(v, u) = 255;
      }
  }

  cv::Mat3f truth(int i) const {
    cv::Mat3f out;
    images[i].convertTo(out, CV_32F);
    return out;
  }

  /// View 8, with its hole interpolated as gray.
  harmonize::FilledFrame interpolated() const {
    harmonize::FilledFrame frame;
    images[8].convertTo(frame.color, CV_32F);
    frame.mask = masks[8].clone();
    frame.kind = cv::Mat1b(masks[8] / 255 * static_cast<uchar>(Kind::interpolated));
    frame.confidence = cv::Mat1b(~masks[8]);
    frame.depth = cv::Mat1f(120, 320, 0.0F);
    frame.provenance = cv::Mat_<cv::Vec3w>(120, 320, cv::Vec3w());
    frame.used = cv::Mat3b(120, 320, cv::Vec3b());
    frame.color.setTo(cv::Scalar::all(110), frame.mask);
    return frame;
  }
  harmonize::FilledFrame run(const harmonize::FilledFrame& frame) const {
    const Views all = memory_views(views, images, masks);
    return synthesize({frame, {}, ground::RoadGround(map, all)}, all, 8, {}).frame;
  }
};

double mean_error_in(const cv::Mat3f& image, const cv::Mat3f& truth, const cv::Mat1b& where) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      if (where(y, x) != 0) {
        sum += std::abs(image(y, x)[1] - truth(y, x)[1]);
        ++count;
      }
  return count > 0 ? sum / count : 0;
}

TEST(Synthesize, StripesOfTheRoadContinueUnderAParkedCar) {
  const Street street;
  const harmonize::FilledFrame before = street.interpolated(), after = street.run(before);
  const cv::Mat1b hole = before.mask;
  ASSERT_GT(cv::countNonZero(hole), 500);
  EXPECT_EQ(cv::countNonZero(cv::Mat1b(after.kind == static_cast<uchar>(Kind::synthesized)) != hole), 0);
  EXPECT_LT(mean_error_in(after.color, street.truth(8), hole), 0.7 * mean_error_in(before.color, street.truth(8), hole));
  const cv::Mat1b outside(~hole);
  EXPECT_EQ(mean_error_in(after.color, street.truth(8), outside), 0);
}

TEST(Synthesize, FragmentsOfCopiesAreReplaced) {
  const Street street;
  harmonize::FilledFrame frame = street.interpolated();
  cv::Mat1b inside;
  cv::erode(frame.mask, inside, cv::Mat1b(9, 9, uchar{1}));
  const std::vector<cv::Point> pixels = Region(inside).pixels;
  ASSERT_FALSE(pixels.empty());
  const cv::Rect fragment(pixels[pixels.size() / 2], cv::Size(3, 3));
  frame.kind(fragment).setTo(static_cast<uchar>(Kind::copied));
  frame.color(fragment).setTo(cv::Scalar(0, 0, 255));
  frame.provenance(fragment).setTo(cv::Scalar(1, 2, 3));
  const harmonize::FilledFrame after = street.run(frame);
  EXPECT_EQ(cv::countNonZero(after.kind(fragment) != static_cast<uchar>(Kind::synthesized)), 0);
  EXPECT_EQ(cv::norm(after.provenance(fragment), cv::NORM_INF), 0);
  EXPECT_LT(cv::mean(after.color(fragment))[2], 150);
}

TEST(Synthesize, CompletedViewsAreNotCompletedAgain) {
  const Street street;
  const harmonize::FilledFrame frame = street.interpolated();
  const Views all = memory_views(street.views, street.images, street.masks);
  const ground::RoadGround ground(street.map, all);
  const SynthesizedFrame first = synthesize({frame, {}, ground}, all, 8, {});
  const CompletedViews completed{make_completed_view(first, all, 8, ground)};
  const SynthesizedFrame again = synthesize({frame, {}, ground}, all, 8, completed);
  EXPECT_GT(cv::countNonZero(first.completed), 500);
  EXPECT_LT(cv::countNonZero(again.completed), 0.02 * cv::countNonZero(first.completed));
  EXPECT_LT(mean_error_in(again.frame.color, first.frame.color, frame.mask), 5);
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
