#include "dvi/baselines/baselines.h"

#include <cmath>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/image/interpolate.h"
#include "dvi/testing/flat_scene.h"
#include "dvi/testing/memory_views.h"

namespace dvi::baselines {
namespace {

constexpr int kWidth = 200, kHeight = 120, kFrames = 9;

/// A scene that moves to the left by `speed` pixels per frame, with a painted hole in each frame.
struct MovingScene {
  std::vector<cv::Mat3b> truth, images;
  std::vector<cv::Mat1b> masks;
  int speed;

  template <class HoleOf>
  MovingScene(int speed_px, const HoleOf& hole_of, cv::Scalar paint = cv::Scalar::all(90)) : speed(speed_px) {
    const cv::Mat3b wide = waves(kWidth + kFrames * speed, kHeight, 5, 12);
    for (int i = 0; i < kFrames; ++i) {
      truth.push_back(wide(cv::Rect(i * speed, 0, kWidth, kHeight)).clone());
      masks.emplace_back(kHeight, kWidth, uchar{0});
      masks.back()(hole_of(i)) = 255;
      images.push_back(truth.back().clone());
      images.back()(hole_of(i)).setTo(paint);
    }
  }

  Views views() const {
    std::vector<View> views(kFrames);
    for (std::size_t i = 0; i < views.size(); ++i) views[i].time_ns = static_cast<std::int64_t>(i) * 100'000'000;
    return memory_views(views, images, masks);
  }
  harmonize::FilledFrame flow(std::size_t target, FlowOptions options = {}) const {
    return fill_along_flow(views(), target, make_hole_flows(views(), options), options);
  }
};

harmonize::Kind get_kind(const harmonize::FilledFrame& frame, cv::Point p) {
  return static_cast<harmonize::Kind>(frame.kind(p));
}

double compute_error(const harmonize::FilledFrame& frame, const cv::Mat3b& truth, cv::Point p) {
  return cv::norm(frame.color(p) - cv::Vec3f(truth(p))) / std::sqrt(3.0);
}

std::size_t count_pixels(const harmonize::FilledFrame& frame, harmonize::Kind kind) {
  return static_cast<std::size_t>(cv::countNonZero(frame.kind == static_cast<uchar>(kind)));
}

void expect_original_outside(const harmonize::FilledFrame& frame, const cv::Mat3b& image, const cv::Mat1b& mask) {
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      ASSERT_EQ(frame.mask(y, x), mask(y, x));
      if (mask(y, x) != 0) continue;
      ASSERT_EQ(frame.color(y, x), cv::Vec3f(image(y, x)));
      ASSERT_EQ(get_kind(frame, {x, y}), harmonize::Kind::original);
      ASSERT_EQ(frame.confidence(y, x), 255);
    }
}

TEST(InpaintFrame, ContinuesAGradient) {
  cv::Mat3b image(60, 80);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) image(y, x) = cv::Vec3b(static_cast<uchar>(3 * x), static_cast<uchar>(2 * y), 70);
  cv::Mat1b mask(image.size(), uchar{0});
  mask(cv::Rect(30, 20, 14, 12)) = 255;
  mask(cv::Rect(0, 50, 10, 10)) = 255;
  const cv::Mat3b truth = image.clone();
  image.setTo(cv::Scalar(255, 0, 255), mask);
  const Views views = memory_views(std::vector<View>(1), {image}, {mask});
  for (const Inpainting method : {Inpainting::telea, Inpainting::navier_stokes}) {
    const harmonize::FilledFrame frame = inpaint_frame(views, 0, method);
    expect_original_outside(frame, image, mask);
    EXPECT_EQ(count_pixels(frame, harmonize::Kind::interpolated), static_cast<std::size_t>(cv::countNonZero(mask)));
    EXPECT_EQ(cv::countNonZero(frame.depth), 0);
    for (int y = 20; y < 32; ++y)
      for (int x = 30; x < 44; ++x) {
        ASSERT_LT(compute_error(frame, truth, {x, y}), 15) << x << " " << y;
        ASSERT_EQ(frame.provenance(y, x), cv::Vec3w());
      }
    EXPECT_LT(frame.confidence(26, 37), frame.confidence(20, 30)) << "the center of the hole is less certain";
    EXPECT_LT(compute_error(frame, truth, {4, 55}), 25) << "a hole in the corner is filled from its two sides";
  }
}

TEST(InpaintFrame, DoesNotUseMaskedPixels) {
  const MovingScene one(0, [](int) { return cv::Rect(0, 30, 60, 90); }, {0, 0, 255});
  const MovingScene other(0, [](int) { return cv::Rect(0, 30, 60, 90); }, {255, 255, 0});
  for (const Inpainting method : {Inpainting::telea, Inpainting::navier_stokes})
    EXPECT_EQ(
        cv::norm(inpaint_frame(one.views(), 0, method).color, inpaint_frame(other.views(), 0, method).color, cv::NORM_INF), 0);
}

TEST(InpaintFrame, LeavesACompletelyMaskedFrameEmpty) {
  const cv::Mat3b image(40, 50, cv::Vec3b(10, 20, 30));
  const harmonize::FilledFrame frame =
      inpaint_frame(memory_views(std::vector<View>(1), {image}, {cv::Mat1b(40, 50, uchar{255})}), 0, Inpainting::telea);
  EXPECT_EQ(count_pixels(frame, harmonize::Kind::empty), frame.kind.total());
  EXPECT_EQ(cv::norm(frame.color), 0);
}

TEST(FillAlongFlow, FollowsAMovingScene) {
  const MovingScene scene(5, [](int) { return cv::Rect(80, 40, 30, 40); });
  const std::size_t target = 4;
  const harmonize::FilledFrame frame = scene.flow(target);
  expect_original_outside(frame, scene.images[target], scene.masks[target]);
  double sum = 0;
  std::size_t copied = 0;
  for (int y = 40; y < 80; ++y)
    for (int x = 80; x < 110; ++x) {
      if (get_kind(frame, {x, y}) != harmonize::Kind::copied) continue;
      ++copied;
      sum += compute_error(frame, scene.truth[target], {x, y});
      const cv::Vec3w provenance = frame.provenance(y, x);
      const int source = provenance[0] - 1;
      const cv::Point2f at(static_cast<float>(provenance[1]) / kSubpixel, static_cast<float>(provenance[2]) / kSubpixel);
      const int frames = source - static_cast<int>(target);
      ASSERT_NEAR(at.x, x - scene.speed * frames, 1.5) << "the provenance is the position of the scene in the source";
      ASSERT_NEAR(at.y, y, 1);
      ASSERT_EQ(frame.color(y, x), bilinear(scene.images[source], at));
      ASSERT_EQ(scene.masks[source](cvRound(at.y), cvRound(at.x)), 0);
      const int frames_left = (x - 80) / scene.speed + 1, frames_right = (109 - x) / scene.speed + 1;
      ASSERT_LE(std::abs(frames), std::min(frames_left, frames_right) + 1) << "the nearest frame in time";
    }
  EXPECT_GT(copied, 0.95 * 30 * 40);
  EXPECT_LT(sum / static_cast<double>(copied), 4);
  EXPECT_EQ(copied + count_pixels(frame, harmonize::Kind::interpolated), 30U * 40U);
}

TEST(FillAlongFlow, CopiesFromBeforeAndAfterForAStaticCamera) {
  const MovingScene scene(0, [](int i) { return cv::Rect(20 + 15 * i, 40, 40, 40); });
  for (const std::size_t target : {std::size_t{0}, std::size_t{4}, std::size_t{8}}) {
    const harmonize::FilledFrame frame = scene.flow(target);
    EXPECT_GT(count_pixels(frame, harmonize::Kind::copied), 0.98 * 40 * 40);
    double sum = 0;
    for (int y = 40; y < 80; ++y)
      for (int x = 0; x < 40; ++x)
        sum += compute_error(frame, scene.truth[target], {20 + 15 * static_cast<int>(target) + x, y});
    EXPECT_LT(sum / (40 * 40), 2);
  }
}

TEST(FillAlongFlow, InpaintsPixelsThatAreAlwaysMasked) {
  const MovingScene scene(0, [](int) { return cv::Rect(80, 40, 30, 40); });
  const harmonize::FilledFrame frame = scene.flow(4);
  EXPECT_EQ(count_pixels(frame, harmonize::Kind::copied), 0U);
  EXPECT_EQ(count_pixels(frame, harmonize::Kind::interpolated), 30U * 40U);
  EXPECT_EQ(cv::norm(frame.color, inpaint_frame(scene.views(), 4, Inpainting::telea).color, cv::NORM_INF), 0);
}

TEST(FillAlongFlow, RespectsTheMaximumNumberOfFrames) {
  const MovingScene scene(5, [](int) { return cv::Rect(80, 40, 30, 40); });
  FlowOptions near;
  near.max_frames = 1;
  const harmonize::FilledFrame frame = scene.flow(4, near);
  for (int y = 40; y < 80; ++y)
    for (int x = 80; x < 110; ++x) {
      if (get_kind(frame, {x, y}) != harmonize::Kind::copied) continue;
      ASSERT_LE(std::abs(frame.provenance(y, x)[0] - 1 - 4), 1);
    }
  EXPECT_GT(count_pixels(frame, harmonize::Kind::interpolated), 15U * 40U);
  EXPECT_GT(count_pixels(frame, harmonize::Kind::copied), 5U * 40U);
}

TEST(FillAlongFlow, DoesNotTrackWithoutSurroundings) {
  const MovingScene all(3, [](int) { return cv::Rect(0, 0, kWidth, kHeight); });
  EXPECT_EQ(count_pixels(all.flow(4), harmonize::Kind::empty), all.masks[4].total());
  const cv::Mat3b small(16, 20, cv::Vec3b(1, 2, 3));
  cv::Mat1b hole(small.size(), uchar{0});
  hole(cv::Rect(5, 5, 4, 4)) = 255;
  const Views views = memory_views(std::vector<View>(2), {small, small}, {hole, hole});
  const harmonize::FilledFrame frame = fill_along_flow(views, 0, make_hole_flows(views, {}), {});
  EXPECT_EQ(count_pixels(frame, harmonize::Kind::interpolated), 16U);
}

TEST(FillAlongFlow, StaysWithinItsDrive) {
  const MovingScene scene(0, [](int i) { return i < 4 ? cv::Rect(80, 40, 30, 40) : cv::Rect(0, 0, 0, 0); });
  std::vector<View> views(kFrames);
  for (std::size_t i = 4; i < kFrames; ++i) views[i].sequence = views[i].drive = 1;
  const Views two = memory_views(views, scene.images, scene.masks);
  EXPECT_EQ(count_pixels(fill_along_flow(two, 3, make_hole_flows(two, {}), {}), harmonize::Kind::copied), 0U);
}

}  // namespace
}  // namespace dvi::baselines
