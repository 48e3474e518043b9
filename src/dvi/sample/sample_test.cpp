#include "dvi/sample/sample.h"

#include <algorithm>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/image/interpolate.h"
#include "dvi/sample/source_score.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::sample {
namespace {

const cv::Rect kHole(30, 20, 10, 10);

cv::Mat1b hole_mask() {
  cv::Mat1b mask(60, 80, uchar{0});
  mask(kHole) = 255;
  return mask;
}

depth::DepthMap flat_depth(const FlatScene& scene) { return {scene.depth(), cv::Mat1f(scene.depth().size(), 0.02F)}; }

Lazy<depth::VisibilityMap> flat_visibility(const FlatScene& scene) {
  return {scene.views.size(), 8, [views = scene.views, masks = scene.masks](std::size_t i) {
            const float z = static_cast<float>(FlatScene::kDepthM + views[i].camera_from_world.t.z());
            return depth::make_visibility_map({cv::Mat1f(masks[i].size(), z), cv::Mat1f(masks[i].size(), 0.02F)}, masks[i]);
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
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  ASSERT_EQ(c.leading.size(), 100);
  for (std::size_t i = 0; i < c.leading.size(); ++i) {
    EXPECT_EQ(c.leading[i].view, 1);
    EXPECT_EQ(c.leading[i].position, cv::Point2f(c.hole.pixels[i]) + cv::Point2f(3, 0));
  }
}

TEST(SampleKnown, FindsPixelsAroundTheHoleInTheSourceFramesOfTheHole) {
  FlatScene scene = drive_of({3, 6, 9});
  scene.masks[1] = cv::Mat1b(60, 80, uchar{255});  // does not observe the hole
  const SampleOptions one{.sources = 1};
  const Candidates hole = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, one);
  scene.masks[1] = cv::Mat1b(60, 80, uchar{0});
  const Candidates known = sample_known({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, hole, one);
  EXPECT_GT(known.hole.size(), 20);
  for (std::size_t i = 0; i < known.leading.size(); ++i) {
    EXPECT_EQ(hole_mask()(known.hole.pixels[i]), 0);
    EXPECT_TRUE(!known.leading[i].found() || known.leading[i].view == hole.leading.front().view);
  }
  EXPECT_TRUE(std::any_of(known.leading.begin(), known.leading.end(), [](const Candidate& c) { return c.found(); }));
}

TEST(SampleKnown, FindsNothingWhereTheHoleHasNoSource) {
  FlatScene scene = drive_of({3});
  scene.masks[1] = cv::Mat1b(60, 80, uchar{255});
  const Candidates hole = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  for (const Candidate& c : sample_known({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, hole, {}).leading)
    EXPECT_FALSE(c.found());
}

TEST(Sample, DoesNotCopySkyFromOtherDrives) {
  FlatScene scene = drive_of({0, 0});
  scene.views[2].sequence = scene.views[2].drive = 1;
  depth::DepthMap sky{cv::Mat1f(60, 80, depth::DepthMap::kInfinity), cv::Mat1f(60, 80, 0.0F)};
  for (const bool own : {true, false}) {
    if (!own) scene.masks[1] = cv::Mat1b(60, 80, uchar{255});
    const Lazy<depth::VisibilityMap> visibility{
        3, 3, [sky, masks = scene.masks](std::size_t i) { return depth::make_visibility_map(sky, masks[i]); }};
    for (const Candidate& c : sample({scene.lazy(), 0, sky, visibility}, {}).leading) EXPECT_EQ(c.view, own ? 1 : -1);
  }
}

TEST(Sample, DoesNotCopySkyFromDistantPartsOfTheDrive) {
  for (const double apart_m : {100, 5000}) {
    FlatScene scene = drive_of({0});
    scene.views[1].camera_from_world.t.z() -= apart_m;  // ahead, so that the sky is inside the image
    depth::DepthMap sky{cv::Mat1f(60, 80, depth::DepthMap::kInfinity), cv::Mat1f(60, 80, 0.0F)};
    const Lazy<depth::VisibilityMap> visibility{
        2, 2, [sky, masks = scene.masks](std::size_t i) { return depth::make_visibility_map(sky, masks[i]); }};
    const std::vector<Candidate> found = sample({scene.lazy(), 0, sky, visibility}, {}).leading;
    EXPECT_EQ(std::any_of(found.begin(), found.end(), [](const Candidate& c) { return c.found(); }), apart_m < 1000);
  }
}

TEST(Sample, SearchesForwardThenBackwardThenOtherDrives) {
  FlatScene scene = drive_of({1, 2, 3, 4});
  scene.views[4].sequence = scene.views[4].drive = 1;
  EXPECT_EQ(list_search_order(scene.lazy(), 2, {.max_frame_gap = 0, .scored = false}), (std::vector<std::size_t>{3, 1, 0, 4}));
  EXPECT_EQ(list_search_order(scene.lazy(), 2, {.max_frame_gap = 1, .scored = false}), (std::vector<std::size_t>{3, 1, 4}));
}

TEST(Sample, SearchesOtherCamerasAsIfTheyWereSecondsFartherAway) {
  FlatScene scene = drive_of({1, 2, 3, 4});
  scene.views[2].time_ns += static_cast<std::int64_t>(1e9 * (kSourceScore.other_camera_s + 1));
  scene.views[3].sequence = scene.views[4].sequence = 1;
  scene.views[3].time_ns = scene.views[1].time_ns + 1;
  scene.views[4].time_ns = scene.views[2].time_ns + 1;
  EXPECT_EQ(list_search_order(scene.lazy(), 0, {.max_frame_gap = 0}), (std::vector<std::size_t>{1, 3, 2, 4}));
  EXPECT_EQ(list_search_order(scene.lazy(), 0, {.max_frame_gap = 1}), (std::vector<std::size_t>{1, 3}))
      << "with the same frame gap";
}

TEST(Sample, DoesNotMixGrayAndColorViews) {
  FlatScene scene = drive_of({1, 2, 3, 4});
  scene.views[3].sequence = scene.views[4].sequence = 1;
  scene.views[3].time_ns = scene.views[1].time_ns + 1;
  scene.views[4].time_ns = scene.views[2].time_ns + 1;
  scene.views[3].gray = scene.views[4].gray = true;
  EXPECT_EQ(list_search_order(scene.lazy(), 0, {.max_frame_gap = 0}), (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(list_search_order(scene.lazy(), 3, {.max_frame_gap = 0}), (std::vector<std::size_t>{4}));
}

TEST(Sample, ScoredSearchIsByDistanceInTime) {
  FlatScene scene = drive_of({1, 2, 3, 4});
  scene.views[4].sequence = scene.views[4].drive = 1;
  EXPECT_EQ(list_search_order(scene.lazy(), 1, {.max_frame_gap = 0}), (std::vector<std::size_t>{2, 0, 3, 4}));
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  ASSERT_EQ(c.extra_per_pixel, 2);
  for (std::size_t i = 0; i < c.leading.size(); ++i) {
    EXPECT_EQ(c.leading[i].view, 1);
    EXPECT_EQ(c.others(i)[0].view, 2);
    EXPECT_EQ(c.others(i)[1].view, 3);
    EXPECT_GT(c.leading[i].score, c.others(i)[0].score);
  }
  for (const Candidate& one : sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {.scored = false}).leading)
    EXPECT_EQ(one.score, 1) << "the published form has no scores";
}

TEST(Sample, HandlesFewerSourcesThanRequested) {
  const FlatScene scene = drive_of({3});
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {.sources = 5});
  for (std::size_t i = 0; i < c.leading.size(); ++i) {
    EXPECT_TRUE(c.leading[i].found());
    for (const Candidate& other : c.others(i)) EXPECT_FALSE(other.found());
  }
}

TEST(Sample, RejectsCandidatesWithLargeErrors) {
  const FlatScene scene = drive_of({3});
  const Views views = scene.lazy();
  const double drift = estimate_position_error_px({}, 0.1);
  const auto finds_any = [&](double max_error_px) {
    const Candidates c = sample({views, 0, flat_depth(scene), flat_visibility(scene)}, {.max_error_px = max_error_px});
    return std::any_of(c.leading.begin(), c.leading.end(), [](const Candidate& one) { return one.found(); });
  };
  EXPECT_FALSE(finds_any(0.99 * drift)) << "drift alone exceeds it";
  EXPECT_TRUE(finds_any(2 * drift)) << "including pixels beside depth edges";
}

// A camera `forward` meters nearer to the plane shows it larger, by 10 / (10 - forward).
void move_last(FlatScene& scene, double forward) { scene.views.back().camera_from_world.t.z() = -forward; }

TEST(Sample, AveragesThePixelsOfANearerSource) {
  FlatScene scene = drive_of({0});
  move_last(scene, 5);
  cv::Mat3b& checker = scene.images.back();
  for (int y = 0; y < checker.rows; ++y)
    for (int x = 0; x < checker.cols; ++x) checker(y, x) = cv::Vec3b::all((x + y) % 2 == 0 ? 0 : 200);
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  const Candidates plain = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {.footprint = false});
  for (std::size_t i = 0; i < c.leading.size(); ++i) {
    ASSERT_EQ(c.leading[i].footprint, cv::Vec2b(2, 2));
    EXPECT_EQ(box_mean(checker, c.leading[i].position, c.leading[i].footprint), cv::Vec3f::all(100));
    EXPECT_EQ(box_mean(checker, plain.leading[i].position, plain.leading[i].footprint), cv::Vec3f::all(0)) << "aliased";
  }
}

TEST(Sample, FootprintsDoNotOverlapTheMask) {
  FlatScene scene = drive_of({0});
  move_last(scene, 8);
  scene.masks.back()(cv::Rect(0, 0, 30, 60)) = 255;
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  int found = 0;
  for (const Candidate& one : c.leading) {
    if (!one.found()) continue;
    ++found;
    EXPECT_GE(one.position.x - 0.5F * static_cast<float>(one.footprint[0] - 1), 30);
  }
  EXPECT_GT(found, 0);
}

TEST(Sample, AFartherSourceHasALowerScore) {
  FlatScene scene = drive_of({0});
  move_last(scene, -10);
  scene.add_source(0, scene.images[0]);
  scene.views[2].time_ns = scene.views[1].time_ns;
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  for (std::size_t i = 0; i < c.leading.size(); ++i) {
    EXPECT_EQ(c.leading[i].view, 2);
    EXPECT_EQ(c.others(i)[0].view, 1);
    EXPECT_LT(c.others(i)[0].score, 0.5F * c.leading[i].score);
  }
}

TEST(Sample, TheSmallestExtentReflectsGrazingAngles) {
  const FlatScene scene = drive_of({0});
  Candidates c{Region(hole_mask()), {}};
  const std::vector<SurfacePixel> pixels = find_surface_pixels(c.hole, scene.views[0].camera, flat_depth(scene));
  ASSERT_EQ(pixels.size(), 100);
  SE3 turned;  // at 60 degrees to the plane's normal, at the same distance
  turned.R = Eigen::AngleAxisd(1.0472, Eigen::Vector3d::UnitY()).toRotationMatrix();
  turned.t = Eigen::Vector3d(0, 0, 10) - turned.R * Eigen::Vector3d(0, 0, 10);
  const Camera& camera = scene.views[0].camera;
  const std::optional<SourcePosition> projection = locate(pixels[55], camera, turned);
  ASSERT_TRUE(projection);
  const std::optional<SourceFootprint> footprint = measure_footprint(pixels[55], *projection, camera, turned);
  ASSERT_TRUE(footprint);
  EXPECT_NEAR(footprint->smallest, 0.5, 0.1);
  EXPECT_NEAR(footprint->down, 1, 0.1);
}

TEST(SourceScore, FollowsItsFormula) {
  SourceFootprint footprint;
  const double far = 1e18;  // px to masks and depth edges
  EXPECT_DOUBLE_EQ(score_source(footprint, 0, far), 1);
  EXPECT_DOUBLE_EQ(score_source(footprint, 1, far), 0.5);
  EXPECT_DOUBLE_EQ(score_source(footprint, 1, far), max_score(1));
  EXPECT_DOUBLE_EQ(score_source(footprint, 0, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(score_source(footprint, 0, 0), 1.0 / 3);
  EXPECT_EQ(score_source(footprint, 0.7, 2.3), max_score(0.7, 2.3));
  footprint.depth_error_px = 0.3;
  EXPECT_DOUBLE_EQ(score_source(footprint, 0, far), 0.5);
  EXPECT_NEAR(estimate_position_error_px(footprint, 1), 0.3 * std::sqrt(2), 1e-12);
  footprint.depth_error_px = 0;
  footprint.smallest = 0.625;
  EXPECT_NEAR(score_source(footprint, 0, far), 0.5, 1e-12);
}

TEST(Sample, SkipsSourcesThatMaskThePixel) {
  FlatScene scene = drive_of({3, 6});
  scene.masks[1] = hole_mask();
  int first = 0, second = 0;
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {.scored = false});
  for (std::size_t i = 0; i < c.leading.size(); ++i) {
    const cv::Point2f at = c.leading[i].position;
    ++(c.leading[i].view == 1 ? first : second);
    if (c.leading[i].view == 1) {
      EXPECT_EQ(hole_mask()(cvRound(at.y), cvRound(at.x)), 0);
    }
    if (c.hole.pixels[i].x + 3 < kHole.br().x) {
      EXPECT_EQ(c.leading[i].view, 2);
    }
  }
  EXPECT_GT(first, 0);
  EXPECT_GT(second, 0);
  for (const Candidate& clear : sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {}).leading)
    EXPECT_EQ(clear.view, 2) << "the score is lower beside the mask of a source";
}

TEST(Sample, PixelsOutsideOfAllSourcesHaveNoCandidate) {
  const FlatScene scene = drive_of({60, -60});
  const Candidates c = sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {});
  for (const Candidate& candidate : c.leading) EXPECT_FALSE(candidate.found());
}

TEST(Sample, RejectsSourcesThatAreOccluded) {
  const FlatScene scene = drive_of({3, 6});
  const Lazy<depth::VisibilityMap> visibility{3, 3, [depth = flat_depth(scene)](std::size_t i) {
                                                depth::DepthMap depth_of_view{depth.z.clone(), depth.sigma};
                                                if (i == 1) depth_of_view.z = 5.0F;  // an object in front of the plane
                                                return depth::make_visibility_map(depth_of_view,
                                                                                  cv::Mat1b(depth_of_view.z.size(), uchar{0}));
                                              }};
  for (const Candidate& c : sample({scene.lazy(), 0, flat_depth(scene), visibility}, {}).leading) EXPECT_EQ(c.view, 2);
  for (const Candidate& c : sample({scene.lazy(), 0, flat_depth(scene), visibility}, {.occlusion_test = false}).leading)
    EXPECT_EQ(c.view, 1);
}

TEST(Sample, RejectsSourcesThatShowASurfaceBehind) {
  const FlatScene scene = drive_of({3, 6});
  const auto behind = [&](float sigma) {
    return Lazy<depth::VisibilityMap>{3, 3, [depth = flat_depth(scene), sigma](std::size_t i) {
                                        depth::DepthMap depth_of_view{depth.z.clone(), depth.sigma.clone()};
                                        if (i == 1) {
                                          depth_of_view.z = 20.0F;
                                          depth_of_view.sigma = sigma;
                                        }
                                        return depth::make_visibility_map(depth_of_view,
                                                                          cv::Mat1b(depth_of_view.z.size(), uchar{0}));
                                      }};
  };
  for (const Candidate& c : sample({scene.lazy(), 0, flat_depth(scene), behind(0.1F)}, {}).leading) EXPECT_EQ(c.view, 2);
  for (const Candidate& c : sample({scene.lazy(), 0, flat_depth(scene), behind(6)}, {}).leading)
    EXPECT_EQ(c.view, 1) << "its depth is too uncertain";
}

TEST(Sample, PixelsWithoutDepthHaveNoCandidate) {
  const FlatScene scene = drive_of({3});
  depth::DepthMap depth = flat_depth(scene);
  depth.z = depth::DepthMap::kUnknown;
  depth.z.rowRange(0, 25) = depth::DepthMap::kSky;
  for (const Candidate& c : sample({scene.lazy(), 0, depth, flat_visibility(scene)}, {}).leading) EXPECT_FALSE(c.found());
}

TEST(Sample, HandlesAnEmptyHole) {
  FlatScene scene = drive_of({3});
  scene.masks[0].setTo(0);
  EXPECT_TRUE(sample({scene.lazy(), 0, flat_depth(scene), flat_visibility(scene)}, {}).leading.empty());
}

}  // namespace
}  // namespace dvi::sample
