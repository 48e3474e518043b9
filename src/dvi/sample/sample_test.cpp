#include "dvi/sample/sample.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/drive/flat_scene.h"

namespace dvi {
namespace {

const cv::Rect kHole(30, 20, 10, 10);

cv::Mat1b hole_mask() {
  cv::Mat1b mask(60, 80, uchar{0});
  mask(kHole) = 255;
  return mask;
}

DepthMap flat_depth(const FlatScene& scene) { return {scene.depth(), cv::Mat1f(scene.depth().size(), 0.02F)}; }

Lazy<VisibilityMap> flat_visibility(const FlatScene& scene, int margin = 0) {
  return {scene.views.size(), 8, [depth = flat_depth(scene), masks = scene.masks, margin](std::size_t i) {
            return visibility_map(depth, masks[i], margin);
          }};
}

// Views of one drive in time order with these disparities; the target is the one with disparity 0.
FlatScene drive_of(const std::vector<int>& disparities) {
  const cv::Mat3b picture = waves(80, 60, 1);
  FlatScene scene(picture, hole_mask());
  for (const int d : disparities) scene.add_source(d, picture);
  return scene;
}

TEST(Sample, TakesTheNextFrameAtTheWarpedPosition) {
  const FlatScene scene = drive_of({3, 6});
  const Candidates c = sample(scene.lazy(), 0, flat_depth(scene), flat_visibility(scene), {});
  ASSERT_EQ(c.of.size(), 100);
  for (std::size_t i = 0; i < c.of.size(); ++i) {
    EXPECT_EQ(c.of[i].view, 1);
    EXPECT_EQ(c.of[i].position, cv::Point2f(c.hole.pixels[i]) + cv::Point2f(3, 0));
  }
}

TEST(Sample, SearchesForwardsThenBackwardsThenOtherDrives) {
  FlatScene scene = drive_of({1, 2, 3, 4});
  scene.views[4].drive = 1;
  EXPECT_EQ(search_order(scene.lazy(), 2, 0), (std::vector<std::size_t>{3, 1, 0, 4}));
  EXPECT_EQ(search_order(scene.lazy(), 2, 1), (std::vector<std::size_t>{3, 1, 4}));
}

TEST(Sample, SkipsSourcesThatMaskThePixel) {
  FlatScene scene = drive_of({3, 6});
  scene.masks[1] = hole_mask();
  int first = 0, second = 0;
  const Candidates c = sample(scene.lazy(), 0, flat_depth(scene), flat_visibility(scene), {});
  for (std::size_t i = 0; i < c.of.size(); ++i) {
    const cv::Point2f at = c.of[i].position;
    ++(c.of[i].view == 1 ? first : second);
    if (c.of[i].view == 1) {
      EXPECT_EQ(hole_mask()(cvRound(at.y), cvRound(at.x)), 0);
    }
    if (c.hole.pixels[i].x + 3 < kHole.br().x) {
      EXPECT_EQ(c.of[i].view, 2);
    }
  }
  EXPECT_GT(first, 0);
  EXPECT_GT(second, 0);
  for (const Candidate& near : sample(scene.lazy(), 0, flat_depth(scene), flat_visibility(scene, 5), {}).of)
    EXPECT_EQ(near.view, 2) << "all within the margin of the mask";
}

TEST(Sample, OutsideTheImageNobodySawIt) {
  const FlatScene scene = drive_of({60, -60});
  const Candidates c = sample(scene.lazy(), 0, flat_depth(scene), flat_visibility(scene), {});
  for (const Candidate& candidate : c.of) EXPECT_FALSE(candidate.found());
}

TEST(Sample, OccludedSourcesDoNotCount) {
  const FlatScene scene = drive_of({3, 6});
  const Lazy<VisibilityMap> visibility{3, 3, [depth = flat_depth(scene)](std::size_t i) {
                                         DepthMap seen{depth.z.clone(), depth.sigma};
                                         if (i == 1) seen.z = 5.0F;  // something stands before the plane there
                                         return visibility_map(seen, cv::Mat1b(seen.z.size(), uchar{0}), 0);
                                       }};
  for (const Candidate& c : sample(scene.lazy(), 0, flat_depth(scene), visibility, {}).of) EXPECT_EQ(c.view, 2);
  for (const Candidate& c : sample(scene.lazy(), 0, flat_depth(scene), visibility, {.occlusion_test = false}).of)
    EXPECT_EQ(c.view, 1);
}

TEST(Sample, NoDepthNoCandidate) {
  const FlatScene scene = drive_of({3});
  DepthMap depth = flat_depth(scene);
  depth.z = DepthMap::kUnknown;
  depth.z.rowRange(0, 25) = DepthMap::kSky;
  for (const Candidate& c : sample(scene.lazy(), 0, depth, flat_visibility(scene), {}).of) EXPECT_FALSE(c.found());
}

TEST(Sample, EmptyHole) {
  FlatScene scene = drive_of({3});
  scene.masks[0].setTo(0);
  EXPECT_TRUE(sample(scene.lazy(), 0, flat_depth(scene), flat_visibility(scene), {}).of.empty());
}

}  // namespace
}  // namespace dvi
