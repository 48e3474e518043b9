#include "dvi/metrics/ghosts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/core/threads.h"
#include "dvi/drive/outline.h"
#include "dvi/media/write_image.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/test_result.h"

namespace dvi::metrics {
namespace {

using testing::HasSubstr;

// Pixels (x, y) from `first` to `last`, both included.
struct PixelRange {
  cv::Point first, last;
  cv::Rect rect() const { return {first, last + cv::Point(1, 1)}; }
};

// The target's frame "a" and a second frame "b" of its drive, 2 m to the right, in whose axes is the world. A car is 10 m in
// front of it: its box of 4 x 2 x 4 m, shrunk to 85 %, covers 8.3 m to 11.7 m.
class Ghost : public ResultFixture {
 protected:
  static constexpr double kFocalPx = 50;
  static constexpr double kCarFirstM = 8.3;

  Ghost() {
    const Camera camera{kSize.width, kSize.height, kFocalPx, kFocalPx, 48, 36, {}};
    scene.objects.push_back({7, "car", Box{{Eigen::Matrix3d::Identity(), {0, 0, 10}}, {4, 2, 4}}});
    scene.frames = {"a", "b"};
    scene.sources = {GhostSource{camera, {Eigen::Matrix3d::Identity(), {2, 0, 0}}}, GhostSource{camera, {}}};
    for (const char* part : {"out/provenance", "out/depth"}) make_folder(folder / part);
  }

  // Fills a part of the hole of frame "a" with pixels of a source, in which they are shifted by 2 m / depth_m.
  void copy(const PixelRange& range, double depth_m, int source = 1, int kind = 1) {
    const int shift = static_cast<int>(std::lround(kFocalPx * -2 / depth_m * 16));
    for (int y = range.first.y; y <= range.last.y; ++y)
      for (int x = range.first.x; x <= range.last.x; ++x) {
        kind_(y, x) = static_cast<uchar>(kind);
        provenance_(y, x) = {static_cast<ushort>(source + 1), static_cast<ushort>(16 * x + shift), static_cast<ushort>(16 * y)};
        depth_(y, x) = static_cast<ushort>(std::lround(256 * depth_m));
      }
  }

  Ghosts count() {
    media::write_png(folder / "out/frames/a.png", cv::Mat3b(kSize));
    media::write_png(folder / "out/kind/a.png", kind_);
    media::write_png(folder / "out/provenance/a.png", provenance_);
    media::write_png(folder / "out/depth/a.png", depth_);
    return count_ghosts(folder / "out", scene);
  }

  GhostScene scene;
  cv::Mat1b kind_{kSize, uchar{0}};
  cv::Mat_<cv::Vec3w> provenance_{kSize, cv::Vec3w()};
  cv::Mat1w depth_{kSize, ushort{0}};
};

// Beside the outline of a car, its box shows the background.
TEST_F(Ghost, IsNotACopyOfTheBackgroundBesideAnOutline) {
  copy({{30, 25}, {69, 50}}, 20);
  cv::Mat1b outline(kSize, uchar{0});
  outline(cv::Rect(40, 33, 5, 4)) = 255;
  scene.sources[1]->outlines[7] = to_outline(outline);
  EXPECT_EQ(count().total.ghosts, 20U);
  scene.sources[1]->outlines = {{8, to_outline(outline)}};
  EXPECT_EQ(count().total.ghosts, 21U * 11) << "the outline of another object";
}

// At 20 m, a pixel of "a" is 5 px farther to the left in "b". There, the car covers x = 48 +- 50 * 1.7 / 8.3 = 37.8 to 58.2 and
// y = 36 +- 50 * 0.85 / 8.3 = 30.9 to 41.1.
TEST_F(Ghost, IsACopyWhoseSourceShowsAnObjectInFrontOfThePoint) {
  copy({{30, 25}, {69, 50}}, 20);
  const Ghosts ghosts = count();
  EXPECT_EQ(ghosts.total.copied, 40U * 26);
  EXPECT_EQ(ghosts.total.ghosts, 21U * 11);
  EXPECT_EQ(ghosts.total.in_map, 0U);
  EXPECT_EQ(ghosts.unjudged, 0U);
  ASSERT_EQ(ghosts.frames.size(), 1U);
  EXPECT_EQ(ghosts.frames[0].name, "a");
  EXPECT_EQ(ghosts.frames[0].counts.ghosts, 21U * 11);
  EXPECT_DOUBLE_EQ(ghosts.total.ghost_share(), 21.0 * 11 / (40 * 26));
}

TEST_F(Ghost, IsNoneInFrontOfTheObjectBesideItOrWithoutACopy) {
  copy({{30, 25}, {69, 50}}, 4);
  EXPECT_EQ(count().total.ghosts, 0U);
  copy({{64, 25}, {69, 50}}, 20);
  EXPECT_EQ(count().total.ghosts, 0U);
  copy({{45, 33}, {60, 39}}, 20, 1, 3);
  const Ghosts ghosts = count();
  EXPECT_EQ(ghosts.total.ghosts, 0U);
  EXPECT_EQ(ghosts.total.copied, 40U * 26 - 16 * 7);
}

TEST_F(Ghost, IsInTheMapIfThePointLiesInTheObject) {
  copy({{50, 33}, {60, 39}}, 10);
  const Ghosts ghosts = count();
  EXPECT_EQ(ghosts.total.ghosts, 0U);
  EXPECT_EQ(ghosts.total.in_map, 11U * 7);
}

TEST_F(Ghost, ShowsTheNearestObjectAndTheSkyIsFar) {
  scene.objects.push_back({9, "truck", Box{{Eigen::Matrix3d::Identity(), {0, 0, 30}}, {8, 8, 4}}});
  copy({{46, 33}, {52, 39}}, 20);
  EXPECT_EQ(count().total.ghosts, 7U * 7) << "the truck is behind the point";
  copy({{46, 33}, {52, 39}}, 500);
  depth_.setTo(0);
  EXPECT_EQ(count().total.ghosts, 7U * 7) << "without depth";
}

// In "a", the car is 2 m to the right: x = 48 + 50 * (0.3 .. 3.7) / 8.3 = 49.8 .. 70.3, and its left side, 50 * 0.3 / 11.7.
TEST_F(Ghost, IsCountedPerTrackInItsOwnSilhouette) {
  copy({{0, 25}, {69, 50}}, 20);
  const Ghosts ghosts = count();
  ASSERT_EQ(ghosts.tracks.size(), 1U);
  EXPECT_EQ(ghosts.tracks[0].track, 7);
  EXPECT_EQ(ghosts.tracks[0].type, "car");
  EXPECT_EQ(ghosts.tracks[0].removed, 20U * 11);
  EXPECT_EQ(ghosts.tracks[0].refilled, 14U * 11) << "x from 50 to 63";
}

TEST_F(Ghost, OfOtherDrivesIsNotJudged) {
  scene.sources.emplace_back();
  copy({{30, 25}, {69, 50}}, 20, 2, 2);
  const Ghosts ghosts = count();
  EXPECT_EQ(ghosts.total.copied, 0U);
  EXPECT_EQ(ghosts.unjudged, 40U * 26);
  EXPECT_DOUBLE_EQ(ghosts.total.ghost_share(), 0);
  EXPECT_TRUE(ghosts.find_worst_frames().empty());
}

TEST_F(Ghost, IsFoundThroughADistortedCameraAsWell) {
  scene.sources[1]->camera.distortion = {-0.05, 0.01, 0, 0, 0};
  copy({{45, 33}, {55, 39}}, 20);
  EXPECT_EQ(count().total.ghosts, 11U * 7);
}

TEST_F(Ghost, IsNoneInABoxAroundTheCameraOrBehindIt) {
  scene.objects[0].world.frame_from_box.t.z() = 0;
  copy({{30, 25}, {69, 50}}, 20);
  EXPECT_EQ(count().total.ghosts, 0U);
  scene.objects[0].world.frame_from_box.t.z() = -10;
  EXPECT_EQ(count().total.ghosts, 0U);
}

TEST_F(Ghost, IsTheSameWithAnyNumberOfThreads) {
  copy({{30, 25}, {69, 50}}, 20);
  const auto dump = [&] { return nlohmann::json(count()).dump(); };
  const std::string parallel = dump();
  const ThreadLimit one(1);
  EXPECT_EQ(dump(), parallel);
}

TEST_F(Ghost, RefusesSourcesThatAreNotListed) {
  copy({{30, 25}, {69, 50}}, 20, 5);
  EXPECT_THAT(input_error([&] { count(); }), HasSubstr("a.png: has a pixel of source 5, which sources.json does not list"));
}

TEST_F(Ghost, IsInTheTableAndInJson) {
  copy({{0, 25}, {69, 50}}, 20);
  Evaluation evaluation;
  evaluation.has_truth = false;
  evaluation.ghosts = count();
  const std::string table = format_table(evaluation);
  EXPECT_THAT(table, HasSubstr("ghosts: 12.69 % of 1820 copied pixels show one of 1 stationary labeled objects"));
  EXPECT_THAT(table, HasSubstr("most in the frames a (231 px)"));
  EXPECT_THAT(table, HasSubstr("70.00 %"));
  EXPECT_THAT(table, testing::Not(HasSubstr("PSNR")));
  const nlohmann::json json = evaluation;
  EXPECT_FALSE(json.contains("all"));
  EXPECT_EQ(json["ghosts"]["ghosts"], 231);
  EXPECT_EQ(json["ghosts"]["tracks"][0]["refilled"], 154);
  EXPECT_EQ(json["ghosts"]["worst_frames"][0]["name"], "a");
}

}  // namespace
}  // namespace dvi::metrics
