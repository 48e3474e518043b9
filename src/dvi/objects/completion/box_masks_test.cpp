#include "dvi/objects/completion/box_masks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/image/region.h"

namespace dvi::objects {
namespace {

cv::Mat1b draw_boxes(const std::vector<cv::Rect>& boxes) {
  cv::Mat1b mask(120, 200, uchar{0});
  for (const cv::Rect& box : boxes) mask(box) = 255;
  return mask;
}

void expect_same(std::vector<cv::Rect> a, std::vector<cv::Rect> b) {
  const auto before = [](const cv::Rect& x, const cv::Rect& y) { return x.x < y.x; };
  std::sort(a.begin(), a.end(), before);
  std::sort(b.begin(), b.end(), before);
  EXPECT_EQ(a, b);
}

TEST(BoxMasks, AreSplitIntoTheirBoxes) {
  const std::vector<std::vector<cv::Rect>> cases{{{20, 30, 60, 40}},
                                                 {{20, 30, 60, 40}, {60, 50, 70, 50}},
                                                 {{20, 30, 100, 20}, {50, 10, 20, 90}},
                                                 {{0, 0, 50, 60}, {30, 40, 60, 79}, {80, 20, 119, 40}}};
  for (const std::vector<cv::Rect>& boxes : cases) expect_same(split_into_boxes(draw_boxes(boxes)), boxes);
}

TEST(BoxMasks, AreRecognizedIfTheyAreDilated) {
  const std::vector<cv::Rect> found = split_into_boxes(grown(draw_boxes({{30, 30, 80, 50}}), 7));
  ASSERT_FALSE(found.empty());
  EXPECT_GE(found.front().area(), 80 * 50);
}

TEST(BoxMasks, AreNotFoundInSilhouettes) {
  cv::Mat1b mask(120, 200, uchar{0});
  EXPECT_TRUE(split_into_boxes(mask).empty());
  cv::ellipse(mask, {100, 60}, {60, 35}, 0, 0, 360, 255, cv::FILLED);
  EXPECT_TRUE(split_into_boxes(mask).empty());
  cv::rectangle(mask, {60, 60, 80, 40}, 255, cv::FILLED);  // the body of a vehicle under a round roof
  EXPECT_TRUE(split_into_boxes(mask).empty());
  EXPECT_TRUE(split_into_boxes(draw_boxes({{50, 50, 5, 5}})).empty()) << "too small for a decision";
}

// A textured gray scene with a red disk, which a box masks, and the returns of a scan every few pixels.
struct DiskInBox {
  cv::Mat3b image = cv::Mat3b(120, 200);
  cv::Mat1b disk = cv::Mat1b(120, 200, uchar{0});
  cv::Mat1b mask = draw_boxes({{60, 20, 80, 80}});
  BoxSeeds seeds{cv::Mat1b(120, 200, uchar{0}), cv::Mat1b(120, 200, uchar{0}), cv::Mat1f(120, 200, 0.F),
                 cv::Mat1b(120, 200, uchar{0})};

  DiskInBox() {
    cv::circle(disk, {100, 60}, 35, 255, cv::FILLED);
    Random random(1);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        const auto level = static_cast<uchar>(110 + 10 * random.normal());
        image(y, x) = disk(y, x) != 0 ? cv::Vec3b(30, 30, level) : cv::Vec3b::all(level);
        if (y % 4 == 0 && x % 3 == 0) (disk(y, x) != 0 ? seeds.object : seeds.background)(y, x) = 255;
      }
  }
};

cv::Mat1b find_background_in_boxes(const DiskInBox& scene, const BoxSeeds& seeds) {
  cv::Mat1b out(scene.mask.size(), uchar{0});
  for (const BoxPart& part : find_box_parts(scene.mask))
    find_background(part, scene.image, seeds).copyTo(out(part.area), part.mask);
  return out;
}

TEST(BoxMasks, AreReducedToTheObjectsInThem) {
  const DiskInBox scene;
  const cv::Mat1b background = find_background_in_boxes(scene, scene.seeds);
  EXPECT_EQ(cv::countNonZero(background & scene.disk), 0);
  EXPECT_EQ(cv::countNonZero(background & ~scene.mask), 0);
  const cv::Mat1b beside(scene.mask & ~grown(scene.disk, 3));
  EXPECT_EQ(cv::countNonZero(beside & ~background), 0);
}

TEST(BoxMasks, HaveTheMarginsOfTheirObjects) {
  DiskInBox scene;
  scene.seeds.margin_px.setTo(8);
  const cv::Mat1b background = find_background_in_boxes(scene, scene.seeds);
  EXPECT_EQ(cv::countNonZero(background & grown(scene.disk, 7)), 0);
  EXPECT_GT(cv::countNonZero(background), 200);
}

TEST(BoxMasks, AreReducedInTheSameWayWhateverTheThreadDidBefore) {
  DiskInBox scene;
  Random random(2);
  for (int y = 0; y < scene.image.rows; ++y)
    for (int x = 0; x < scene.image.cols; ++x) {
      // Colors that leave the border to chance.
      for (int c = 0; c < 3; ++c)
        scene.image(y, x)[c] = static_cast<uchar>(random.below(256) / (scene.disk(y, x) == 0 && c > 0 ? 2 : 1));
      if (y % 12 != 0 || x % 9 != 0) scene.seeds.object(y, x) = scene.seeds.background(y, x) = 0;
    }
  cv::Mat1b first;
  for (const int seed : {1, 2, 3, 4, 5}) {
    cv::setRNGSeed(seed);
    const cv::Mat1b background = find_background_in_boxes(scene, scene.seeds);
    if (first.empty()) first = background;
    EXPECT_GT(cv::countNonZero(background), 0);
    EXPECT_EQ(cv::norm(background, first, cv::NORM_INF), 0);
  }
}

TEST(BoxMasks, AreReducedToTheirObjectsAlsoIfTheyAreLarge) {
  DiskInBox scene;
  const auto enlarge = [](auto& image) { cv::resize(image, image, {}, 4, 4, cv::INTER_NEAREST); };
  enlarge(scene.image);
  enlarge(scene.disk);
  enlarge(scene.mask);
  enlarge(scene.seeds.object);
  enlarge(scene.seeds.background);
  enlarge(scene.seeds.margin_px);
  enlarge(scene.seeds.ground);
  const cv::Mat1b background = find_background_in_boxes(scene, scene.seeds);
  EXPECT_EQ(cv::countNonZero(background & scene.disk), 0);
  const cv::Mat1b beside(scene.mask & ~grown(scene.disk, 14));
  EXPECT_EQ(cv::countNonZero(beside & ~background), 0);
}

TEST(BoxMasks, RemainWithoutReturns) {
  DiskInBox scene;
  const cv::Mat1b none(scene.mask.size(), uchar{0});
  EXPECT_EQ(cv::countNonZero(find_background_in_boxes(scene, {none, scene.seeds.background, scene.seeds.margin_px, none})), 0)
      << "no return on the object";
  EXPECT_EQ(cv::countNonZero(find_background_in_boxes(scene, {scene.seeds.object, none, scene.seeds.margin_px, none})), 0)
      << "no return on the background";
  EXPECT_TRUE(find_box_parts(none).empty());
}

TEST(BoxMasks, RemainWhereABoxHasNoReturnsOfItsOwnObject) {
  DiskInBox scene;
  const cv::Rect other(130, 60, 50, 50);  // overlaps the box of the disk
  scene.mask(other) = 255;
  const cv::Mat1b background = find_background_in_boxes(scene, scene.seeds);
  cv::Mat1b own(scene.mask.size(), uchar{0});
  own(other) = 255;
  own(cv::Rect(60, 20, 80, 80)) = 0;
  EXPECT_EQ(cv::countNonZero(background & own), 0);
  EXPECT_GT(cv::countNonZero(background), 1000) << "the box of the disk is reduced";
}

TEST(BoxMasks, RemainIfTheirObjectDoesNotReachAcrossThem) {
  for (const cv::Rect& other : {cv::Rect(60, 20, 140, 80), cv::Rect(5, 20, 135, 80)}) {
    DiskInBox scene;
    scene.mask.setTo(0);
    scene.mask(other) = 255;  // a rectangle in which the disk is on one side
    EXPECT_EQ(cv::countNonZero(find_background_in_boxes(scene, scene.seeds)), 0) << other;
  }
}

TEST(BoxMasks, HaveFixedPixelsThatNearlyAllMasksCover) {
  const auto fixed_of = [](std::size_t frames) {
    return find_fixed_pixels({frames, [](std::size_t i) {
                                cv::Mat1b mask = draw_boxes({{20, 80, 100, 30}});  // a banner
                                if (i != 3) mask(cv::Rect(static_cast<int>(10 * i % 150), 10, 40, 40)) = 255;
                                if (i == 5) mask.setTo(0);  // a frame without masks
                                return mask;
                              }});
  };
  EXPECT_EQ(cv::norm(fixed_of(30), draw_boxes({{20, 80, 100, 30}}), cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(fixed_of(1000), draw_boxes({{20, 80, 100, 30}}), cv::NORM_INF), 0);
  EXPECT_TRUE(fixed_of(4).empty());
}

TEST(BoxMasks, KeepTheGroundBesideTheirObjects) {
  DiskInBox scene;
  for (int y = 84; y < 100; y += 4)
    for (int x = 60; x < 140; x += 3)
      if (scene.seeds.background(y, x) != 0) scene.seeds.ground(y, x) = 255, scene.seeds.background(y, x) = 0;
  const cv::Mat1b background = find_background_in_boxes(scene, scene.seeds);
  EXPECT_EQ(cv::countNonZero(background(cv::Rect(62, 88, 76, 10))), 0);
  EXPECT_GT(cv::countNonZero(background(cv::Rect(60, 20, 20, 20))), 100);
}

}  // namespace
}  // namespace dvi::objects
