#include "dvi/synthesize/noise_texture.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/depth/depth_map.h"
#include "dvi/harmonize/surface_class.h"
#include "dvi/testing/memory_views.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

constexpr int kColumns = 240, kRows = 80;
constexpr double kDistance = 40;  // meters from the first view to the wall ahead

/// A camera that faces a wall and approaches it by a meter per view.
View approaching_view(int i) {
  View view;
  view.camera = {kColumns, kRows, 250, 250, 119.5, 39.5, {}};
  view.camera_from_world.t = Eigen::Vector3d(0, 0, -i);
  return view;
}

Views views_of(int count) {
  std::vector<View> views;
  for (int i = 0; i < count; ++i) views.push_back(approaching_view(i));
  return memory_views(views, std::vector<cv::Mat3b>(views.size()), std::vector<cv::Mat1b>(views.size()));
}

cv::Mat1f wall(int i) { return cv::Mat1f(kRows, kColumns, static_cast<float>(kDistance - i)); }

/// A frame with a pattern of the given contrast, and a hole.
harmonize::FilledFrame frame_of(float contrast, const cv::Rect& hole) {
  harmonize::FilledFrame frame;
  frame.color = cv::Mat3f(kRows, kColumns, cv::Vec3f::all(120));
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x)
      if (!hole.contains({x, y})) frame.color(y, x) += cv::Vec3f::all((x / 2 + y / 2) % 2 == 0 ? contrast : -contrast);
  frame.mask = cv::Mat1b(kRows, kColumns, uchar{0});
  frame.mask(hole).setTo(255);
  frame.kind = cv::Mat1b(frame.mask / 255 * static_cast<uchar>(Kind::interpolated));
  return frame;
}

const cv::Mat1b kUnknown(kRows, kColumns, static_cast<uchar>(harmonize::SurfaceClass::unknown));

/// Computes the noise texture of a frame; its depth is that of the wall if it has none.
cv::Mat1f compute_noise(const Views& views, int i, harmonize::FilledFrame frame, const cv::Mat1b& classes = kUnknown) {
  if (frame.depth.empty()) frame.depth = wall(i);
  const Region region(frame.mask);
  const std::vector<cv::Vec3f> found = NoiseTexture(views).compute(frame, region, views[static_cast<std::size_t>(i)], classes);
  cv::Mat1f out(frame.mask.size(), 0.0F);
  for (std::size_t k = 0; k < region.size(); ++k) out(region.pixels[k]) = found[k][1];
  return out;
}

double deviation_of(const cv::Mat1f& image, const cv::Mat1b& mask) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation, mask);
  return deviation[0];
}

const cv::Rect kHole(80, 20, 80, 40);

TEST(NoiseTexture, IsAsStrongAsTheSurroundingsOfTheHole) {
  const Views views = views_of(12);
  double before = -1;
  for (const float contrast : {0.0F, 5.0F, 10.0F, 20.0F}) {
    const harmonize::FilledFrame frame = frame_of(contrast, kHole);
    const double deviation = deviation_of(compute_noise(views, 5, frame), frame.mask);
    EXPECT_GT(deviation, before);
    EXPECT_LE(deviation, 1.2 * contrast + 0.01);
    before = deviation;
  }
  EXPECT_GT(before, 10);
}

TEST(NoiseTexture, MovesWithTheSurfaceAsTheCameraApproaches) {
  const Views views = views_of(12);
  const harmonize::FilledFrame frame = frame_of(10, kHole);
  const cv::Mat1f a = compute_noise(views, 4, frame), b = compute_noise(views, 5, frame);
  double both = 0, first = 0, second = 0, still = 0;
  const double nearer = (kDistance - 4) / (kDistance - 5);  // growth of the image
  for (int y = 24; y < 56; ++y)
    for (int x = 84; x < 156; ++x) {
      const int u = static_cast<int>(std::lround(119.5 + nearer * (x - 119.5)));
      const int v = static_cast<int>(std::lround(39.5 + nearer * (y - 39.5)));
      both += a(y, x) * b(v, u);
      still += a(y, x) * b(y, x);
      first += a(y, x) * a(y, x);
      second += b(v, u) * b(v, u);
    }
  EXPECT_GT(both / std::sqrt(first * second), 0.75);
  EXPECT_GT(both, still);
}

TEST(NoiseTexture, IsDeterministic) {
  const harmonize::FilledFrame frame = frame_of(10, kHole);
  EXPECT_EQ(cv::norm(compute_noise(views_of(12), 7, frame), compute_noise(views_of(12), 7, frame), cv::NORM_INF), 0);
}

TEST(NoiseTexture, ExistsForASingleViewWithoutDepth) {
  const Views views = views_of(1);
  harmonize::FilledFrame frame = frame_of(10, kHole);
  frame.depth = cv::Mat1f(kRows, kColumns, depth::DepthMap::kUnknown);
  const Region region(frame.mask);
  double square = 0;
  for (const cv::Vec3f& g : NoiseTexture(views).compute(frame, region, views[0], kUnknown)) square += g[1] * g[1];
  EXPECT_GT(std::sqrt(square / static_cast<double>(region.size())), 2);
}

TEST(NoiseTexture, OnTheGroundIsAsStrongAsOnKnownGround) {
  const Views views = views_of(12);
  harmonize::FilledFrame frame = frame_of(20, kHole);
  cv::Mat1b classes(kRows, kColumns, static_cast<uchar>(harmonize::SurfaceClass::upright));
  classes.rowRange(40, kRows).setTo(static_cast<uchar>(harmonize::SurfaceClass::ground));
  frame.color.rowRange(40, kRows).setTo(cv::Scalar::all(120));
  cv::Mat1b above = frame.mask.clone(), below = frame.mask.clone();
  above.rowRange(36, kRows).setTo(0);
  below.rowRange(0, 44).setTo(0);
  const cv::Mat1f noise = compute_noise(views, 5, frame, classes);
  EXPECT_GT(deviation_of(noise, above), 10);
  EXPECT_LT(deviation_of(noise, below), 1.5);
  const cv::Mat1f of_all = compute_noise(views, 5, frame);
  EXPECT_GT(deviation_of(of_all, below), 2 * deviation_of(noise, below));
}

TEST(NoiseTexture, InTheSkyIsAsStrongAsInKnownSky) {
  const Views views = views_of(12);
  harmonize::FilledFrame frame = frame_of(20, kHole);
  frame.color.rowRange(0, 40).setTo(cv::Scalar::all(120));
  harmonize::FilledFrame with_sky = frame;
  with_sky.depth = wall(5);
  with_sky.depth.rowRange(0, 40).setTo(depth::DepthMap::kSky, ~frame.mask.rowRange(0, 40));
  with_sky.depth.rowRange(0, 40).setTo(depth::DepthMap::kInfinity, frame.mask.rowRange(0, 40));
  const cv::Mat1b upright(kRows, kColumns, static_cast<uchar>(harmonize::SurfaceClass::upright));
  cv::Mat1b above = frame.mask.clone(), below = frame.mask.clone();
  above.rowRange(36, kRows).setTo(0);
  below.rowRange(0, 44).setTo(0);
  const cv::Mat1f noise = compute_noise(views, 5, with_sky, upright);
  EXPECT_LT(deviation_of(noise, above), 1.5);
  EXPECT_GT(deviation_of(noise, below), 10);
  EXPECT_GT(deviation_of(compute_noise(views, 5, frame, upright), above), 2 * deviation_of(noise, above));
}

TEST(NoiseTexture, IsNoneWithoutKnownPixels) {
  const Views views = views_of(3);
  const harmonize::FilledFrame frame = frame_of(10, {0, 0, kColumns, kRows});
  EXPECT_LT(cv::norm(compute_noise(views, 1, frame), cv::NORM_INF), 1e-3);
}

}  // namespace
}  // namespace dvi::synthesize
