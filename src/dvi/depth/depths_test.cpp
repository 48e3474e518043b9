#include "dvi/depth/depths.h"

#include <gtest/gtest.h>

#include <atomic>

#include <opencv2/core.hpp>

#include "dvi/core/random.h"
#include "dvi/depth/packed_depth.h"
#include "dvi/depth/test_map.h"
#include "dvi/testing/memory_views.h"

namespace dvi::depth {
namespace {

const cv::Size kSize(61, 40);

/// Sky above surfaces with gaps of unknown depth.
DepthMap random_depth(std::size_t seed) {
  Random random(seed + 1);
  DepthMap out{cv::Mat1f(kSize, DepthMap::kSky), cv::Mat1f(kSize, 0.0F)};
  for (int y = 12; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      if (x / 4 % 5 == 0 || random.below(30) == 0) {
        out.z(y, x) = DepthMap::kUnknown;
        continue;
      }
      out.z(y, x) = static_cast<float>(random.uniform(2, 50));
      out.sigma(y, x) = static_cast<float>(random.uniform(0.01, 1));
    }
  return out;
}

cv::Mat1b make_hole() {
  cv::Mat1b hole(kSize, uchar{0});
  hole(cv::Rect(20, 10, 17, 15)) = 255;
  return hole;
}

bool are_equal(const cv::Mat& a, const cv::Mat& b) { return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0; }

void expect_same(const DepthMap& depth, const DepthMap& truth, const cv::Mat1b& hole) {
  cv::Mat1f finite = depth.z.clone(), finite_truth = truth.z.clone();
  for (cv::Mat1f* z : {&finite, &finite_truth}) z->setTo(-1, *z == DepthMap::kSky);
  EXPECT_TRUE(are_equal(finite, finite_truth));
  cv::Mat1f sigma(kSize, 0.0F), sigma_truth(kSize, 0.0F);
  depth.sigma.copyTo(sigma, hole);
  truth.sigma.copyTo(sigma_truth, hole);
  EXPECT_TRUE(are_equal(sigma, sigma_truth));
}

TEST(PackedDepth, RestoresDepthsAndTheSigmaOfTheHole) {
  const cv::Mat1b hole = make_hole();
  const DepthMap depth = random_depth(0);
  const PackedDepth packed(depth, hole);
  expect_same(packed.unpack(hole), depth, hole);
  EXPECT_LT(packed.bytes(), 5 * depth.z.total());
  const DepthMap sky{cv::Mat1f(kSize, DepthMap::kSky), cv::Mat1f(kSize, 0.0F)};
  expect_same(PackedDepth(sky, hole).unpack(hole), sky, hole);
}

TEST(Depths, AreComputedOnceForViewsThatAreFirstASourceAndThenTheTarget) {
  constexpr std::size_t kViews = 40;
  View view = test_view();
  view.camera.width = kSize.width;
  view.camera.height = kSize.height;
  const Views views = memory_views(std::vector<View>(kViews, view), std::vector<cv::Mat3b>(kViews),
                                   std::vector<cv::Mat1b>(kViews, make_hole()));
  std::atomic<int> computed = 0;
  const Depths depths(views, [&](std::size_t i) {
    ++computed;
    return random_depth(i);
  });
  for (std::size_t target = 0; target < kViews; ++target) {
    const DepthMap depth = depths.make_map(target);
    expect_same(depth, random_depth(target), make_hole());
    EXPECT_EQ(cv::countNonZero(cv::Mat1f(depth.sigma.clone().setTo(0, make_hole()))), 0);
    for (std::size_t source = 0; source < kViews; ++source) {
      const VisibilityMap expected = make_visibility_map(random_depth(source), make_hole());
      EXPECT_TRUE(are_equal(depths.visibility[source]->farthest, expected.farthest));
      EXPECT_TRUE(are_equal(depths.visibility[source]->spread, expected.spread));
    }
  }
  EXPECT_EQ(computed, static_cast<int>(kViews));
}

}  // namespace
}  // namespace dvi::depth
