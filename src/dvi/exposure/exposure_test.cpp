#include "dvi/exposure/exposure.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/drive/view.h"
#include "dvi/drive/vignetting.h"
#include "dvi/map/static_map.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::exposure {
namespace {

constexpr int kWidth = 160, kHeight = 120;

/// Points on the plane of a FlatScene, one for every other pixel of view 0 and on both sides of it.
map::StaticMap make_plane() {
  map::StaticMap map;
  for (int y = 0; y < kHeight; y += 2)
    for (int x = -kWidth; x < 2 * kWidth; x += 2)
      map.points.push_back({Eigen::Vector3d((x - kWidth / 2.0) / 10, (y - kHeight / 2.0) / 10, 10).cast<float>(), 0, 1});
  map.tiles = {{Eigen::AlignedBox3f(Eigen::Vector3f(-30, -10, 9), Eigen::Vector3f(30, 10, 11)), 0, map.points.size()}};
  return map;
}

cv::Mat3b multiply(const cv::Mat3b& image, const cv::Vec3d& factor) {
  cv::Mat3b out(image.size());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c) out(y, x)[c] = cv::saturate_cast<uchar>(image(y, x)[c] * factor[c]);
  return out;
}

/// Views of a wall with different exposures.
struct LitWall {
  FlatScene scene;
  std::vector<cv::Vec3d> light;

  explicit LitWall(const std::vector<cv::Vec3d>& factors, int drives = 1)
      : scene(multiply(waves(kWidth, kHeight, 5, 30), factors.front()), cv::Mat1b(kHeight, kWidth, uchar{0})), light(factors) {
    for (std::size_t i = 1; i < factors.size(); ++i)
      scene.add_source(-2 * static_cast<int>(i % 5), multiply(waves(kWidth, kHeight, 5, 30), factors[i]),
                       static_cast<int>(i * drives / factors.size()));
  }
  Views apply_estimate(std::vector<int>* compared = nullptr, const map::StaticMap& map = make_plane()) const {
    Views views = scene.lazy();
    const Gains gains = estimate_exposure(views, {map, views});
    if (compared != nullptr) *compared = gains.compared;
    for (std::size_t i = 0; i < views.size(); ++i) views.views[i].gain = gains.of_view[i];
    return views;
  }
  /// Returns the largest relative error of the gain from a view to the first view.
  double max_error(const Views& views) const {
    double error = 0;
    for (std::size_t i = 1; i < views.size(); ++i)
      for (int c = 0; c < 3; ++c)
        error = std::max(error, std::abs(gain_to(views[0], views[i])[c] * light[i][c] / light[0][c] - 1));
    return error;
  }
};

std::vector<cv::Vec3d> make_drift(int count) {
  std::vector<cv::Vec3d> out;
  for (int i = 0; i < count; ++i) out.emplace_back(1 - 0.03 * i, 0.8 + 0.02 * i, 0.9 + 0.1 * std::sin(i));
  return out;
}

TEST(Exposure, FindsGainAndWhiteBalance) {
  const LitWall lit(make_drift(12));
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.005);
}

/// Applies the vignetting cos^(2 k) to the scene.
void add_vignetting(FlatScene& scene, float k) {
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    View through = scene.views[i];
    through.vignetting = k;
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x) scene.images[i](y, x) *= vignetting(through, cv::Point(x, y));
  }
}

TEST(Exposure, FindsVignetting) {
  for (const float k : {0.3F, 0.9F}) {
    LitWall lit(std::vector<cv::Vec3d>(24, cv::Vec3d::all(1)));
    add_vignetting(lit.scene, k);
    const Views views = lit.scene.lazy();
    const map::StaticMap map = make_plane();
    const Gains gains = estimate_exposure(views, {map, views});
    for (const float found : gains.vignetting) EXPECT_NEAR(found, k, 0.1F * k);
    for (const cv::Vec3f& gain : gains.of_view) EXPECT_NEAR(gain[1], 1, 0.005);
  }
}

TEST(Exposure, FindsNoVignettingWithoutIt) {
  const LitWall lit(make_drift(24));
  const Views views = lit.scene.lazy();
  const map::StaticMap map = make_plane();
  for (const float found : estimate_exposure(views, {map, views}).vignetting) EXPECT_EQ(found, 0);
}

TEST(Exposure, KeepsTheMeanOfTheLogarithms) {
  const Views views = LitWall(make_drift(5)).apply_estimate();
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (const View& view : views.views) sum += std::log(view.gain[c]);
    EXPECT_NEAR(sum, 0, 1e-4);
  }
}

TEST(Exposure, IsRobustToMovingObjects) {
  LitWall lit(make_drift(12));
  Random random(4);
  for (cv::Mat3b& image : lit.scene.images)
    for (int k = 0; k < 4; ++k)
      cv::rectangle(image, {static_cast<int>(random.uniform(0, 120)), static_cast<int>(random.uniform(0, 90)), 36, 30},
                    cv::Scalar(random.uniform(10, 240), random.uniform(10, 240), random.uniform(10, 240)), cv::FILLED);
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.015);
}

// From afar, the texture of a surface is blurred. Its mean color remains.
TEST(Exposure, IsTheSameForBlurredTexture) {
  LitWall lit(std::vector<cv::Vec3d>(8, {1, 1, 1}));
  for (std::size_t i = 0; i < lit.scene.images.size(); ++i) {
    cv::Mat3b& image = lit.scene.images[i];
    for (cv::Vec3b& color : image)  // few bright spots
      for (int c = 0; c < 3; ++c) color[c] = cv::saturate_cast<uchar>(20 + 180 * std::pow(color[c] / 255.0, 3));
    if (i >= 4) cv::GaussianBlur(image, image, {}, 6);
  }
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.02);
}

TEST(Exposure, IgnoresMaskedPixels) {
  LitWall lit(make_drift(4));
  for (std::size_t i = 0; i < 4; ++i) {
    const cv::Rect hole(10, 5, 100, 100);
    lit.scene.masks[i](hole) = 255;
    lit.scene.images[i](hole) = cv::Vec3b(static_cast<uchar>(60 * i), 90, 130);
  }
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.005);
}

TEST(Exposure, IgnoresSaturatedPixels) {
  const LitWall lit({{1, 1, 1}, {1.3, 1.3, 1.3}, {0.8, 1.25, 1.1}});
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.005);
}

TEST(Exposure, FollowsASuddenStep) {
  std::vector<cv::Vec3d> light(8, {1, 1, 1});
  light.insert(light.end(), 8, {0.5, 0.5, 0.5});
  const LitWall lit(light);
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.005);
}

TEST(Exposure, NeedsOnlyTwoFrames) {
  const LitWall lit({{1, 1, 1}, {0.8, 0.9, 1.1}});
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.005);
}

TEST(Exposure, AdaptsAnotherDrive) {
  std::vector<cv::Vec3d> light(4, {1, 1, 1});
  light.insert(light.end(), 4, {1.1, 0.8, 0.6});
  const LitWall lit(light, 2);
  EXPECT_LT(lit.max_error(lit.apply_estimate()), 0.005);
}

TEST(Exposure, GrayViewsDoNotInfluenceColoredViews) {
  std::vector<cv::Vec3d> light(3, {1, 0.9, 1.1});
  light.insert(light.end(), 3, {1.1, 0.8, 0.6});
  LitWall lit(light, 2);
  const std::vector<cv::Vec3f> alone = [&] {
    LitWall colored({light.begin(), light.begin() + 3});
    const Views views = colored.apply_estimate();
    return std::vector<cv::Vec3f>{views[0].gain, views[1].gain, views[2].gain};
  }();
  for (std::size_t i = 3; i < 6; ++i) lit.scene.views[i].gray = true;
  const Views views = lit.apply_estimate();
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(cv::norm(views[i].gain - alone[i]), 1e-6) << i;
  for (std::size_t i = 3; i < 6; ++i) EXPECT_LT(cv::norm(views[i].gain - cv::Vec3f(1, 1, 1)), 1e-6) << i;
}

TEST(Exposure, DoesNotChangeBlackAndWhiteFrames) {
  LitWall lit(make_drift(6));
  lit.scene.images[2] = cv::Vec3b(0, 0, 0);
  lit.scene.images[4] = cv::Vec3b(255, 255, 255);
  std::vector<int> compared;
  const Views views = lit.apply_estimate(&compared);
  for (const std::size_t i : {2, 4}) {
    EXPECT_EQ(compared[i], 0);
    EXPECT_EQ(views[i].gain, cv::Vec3f(1, 1, 1));
  }
  for (const std::size_t i : {1, 3, 5}) EXPECT_NEAR(gain_to(views[0], views[i])[0] * lit.light[i][0], 1, 0.005);
}

TEST(Exposure, DoesNotChangeFramesWithoutCommonPoints) {
  std::vector<int> compared;
  const Views views = LitWall(make_drift(3)).apply_estimate(&compared, map::StaticMap());
  EXPECT_EQ(compared, std::vector<int>(3, 0));
  for (const View& view : views.views) EXPECT_EQ(view.gain, cv::Vec3f(1, 1, 1));
}

}  // namespace
}  // namespace dvi::exposure
