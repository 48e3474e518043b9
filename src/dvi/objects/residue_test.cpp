#include "dvi/objects/residue.h"

#include <cstdint>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace dvi::objects {
namespace {

constexpr int kWidthPx = 160, kHeightPx = 120;

// A smooth random texture.
cv::Mat3b make_texture(std::uint64_t seed) {
  cv::Mat3b out(kHeightPx, kWidthPx);
  cv::RNG(seed).fill(out, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(out, out, {}, 1.5);
  return out;
}

// An object in front of a background. The result shows the background, and all of the object is removed.
struct Scene {
  cv::Rect box;
  cv::Mat3b background = make_texture(1), object = make_texture(2);
  ResultImages images{background.clone(), background.clone(), cv::Mat1b(kHeightPx, kWidthPx, uchar{255}),
                      cv::Mat1b(kHeightPx, kWidthPx, uchar{255})};

  explicit Scene(const cv::Rect& box_of_object = {40, 30, 40, 30}) : box(box_of_object) { show_object(images.input); }

  // Draws the object, displaced by `shift`, into the pixels of its silhouette.
  void show_object(cv::Mat3b& image, const cv::Point& shift = {}) const {
    const cv::Rect visible = (box + shift) & box;
    object(visible - shift).copyTo(image(visible));
  }
  std::optional<FrameResidue> measure() const {
    cv::Mat1b silhouette(kHeightPx, kWidthPx, uchar{0});
    silhouette(box) = 255;
    return measure_residue(images, silhouette);
  }
};

TEST(Residue, IsLowWhereTheBackgroundIsVisible) {
  const std::optional<FrameResidue> residue = Scene().measure();
  ASSERT_TRUE(residue);
  EXPECT_LT(residue->similarity, 0.15);
  EXPECT_EQ(residue->unmasked, 0);
  EXPECT_FALSE(residue->is_visible());
}

TEST(Residue, IsHighWhereTheObjectRemains) {
  Scene scene;
  scene.show_object(scene.images.result);
  ASSERT_TRUE(scene.measure());
  EXPECT_GT(scene.measure()->similarity, 0.9);
  EXPECT_TRUE(scene.measure()->is_visible());
}

TEST(Residue, IsHighWhereTheObjectIsDisplaced) {
  Scene scene;
  scene.show_object(scene.images.result, {7, -4});
  EXPECT_GT(scene.measure()->similarity, 0.6);
}

TEST(Residue, OfALargeObjectIsMeasuredInASmallerImage) {
  Scene scene({5, 5, 150, 110});
  EXPECT_FALSE(scene.measure()->is_visible());
  scene.show_object(scene.images.result);
  EXPECT_GT(scene.measure()->similarity, 0.9);
}

TEST(Residue, DoesNotCountTheBorder) {
  Scene scene;
  scene.background(scene.box).copyTo(scene.images.input(scene.box));
  const cv::Rect inner(scene.box.x + 2, scene.box.y + 2, scene.box.width - 4, scene.box.height - 4);
  scene.object(inner).copyTo(scene.images.input(inner));
  EXPECT_LT(scene.measure()->similarity, 0.15) << "the silhouette is 2 px too large";
}

TEST(Residue, OfAnObjectWithoutTextureIsUnknown) {
  Scene scene;
  scene.images.input(scene.box) = cv::Vec3b(80, 90, 100);
  scene.images.result(scene.box) = cv::Vec3b(80, 90, 100);
  ASSERT_TRUE(scene.measure());
  EXPECT_FALSE(scene.measure()->is_visible());
  scene.images.removed(scene.box) = 0;
  EXPECT_TRUE(scene.measure()->is_visible()) << "nothing of it was removed";
}

TEST(Residue, OfAnObjectThatIsNotRemovedIsComplete) {
  Scene scene;
  scene.show_object(scene.images.result);
  scene.images.removed(scene.box) = 0;
  EXPECT_EQ(scene.measure()->unmasked, 1);
  EXPECT_EQ(scene.measure()->score(), 1);
}

TEST(Residue, OfATinyObjectIsNotMeasured) {
  EXPECT_FALSE(Scene({40, 30, 6, 6}).measure());
  EXPECT_FALSE(Scene({40, 30, 0, 0}).measure());
}

TEST(Residue, IsNotMadeOfPixelsThatWereNotCopied) {
  Scene scene;
  scene.show_object(scene.images.result);
  scene.images.copied(scene.box) = 0;
  EXPECT_EQ(scene.measure()->similarity, 0);
}

}  // namespace
}  // namespace dvi::objects
