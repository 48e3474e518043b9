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
  cv::RNG(seed * 0x9e3779b97f4a7c15U).fill(out, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(out, out, {}, 1.5);
  return out;
}

// An object in front of a background. The result shows the background, and all of the object is removed.
struct RemovedRectangle {
  cv::Rect box;
  cv::Mat3b background = make_texture(1), object = make_texture(2);
  ResultImages images{background.clone(), background.clone(), cv::Mat1b(kHeightPx, kWidthPx, uchar{255}),
                      cv::Mat1b(kHeightPx, kWidthPx, uchar{255})};

  explicit RemovedRectangle(const cv::Rect& box_of_object = {40, 30, 40, 30}) : box(box_of_object) {
    show_object(images.input);
  }

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
  const std::optional<FrameResidue> residue = RemovedRectangle().measure();
  ASSERT_TRUE(residue);
  EXPECT_LT(residue->similarity, 0.15);
  EXPECT_EQ(residue->unmasked, 0);
  EXPECT_FALSE(residue->is_visible());
}

TEST(Residue, IsHighWhereTheObjectRemains) {
  RemovedRectangle rectangle;
  rectangle.show_object(rectangle.images.result);
  ASSERT_TRUE(rectangle.measure());
  EXPECT_GT(rectangle.measure()->similarity, 0.9);
  EXPECT_TRUE(rectangle.measure()->is_visible());
}

TEST(Residue, IsHighWhereTheObjectIsDisplaced) {
  RemovedRectangle rectangle;
  rectangle.show_object(rectangle.images.result, {7, -4});
  EXPECT_GT(rectangle.measure()->similarity, 0.6);
}

TEST(Residue, OfALargeObjectIsMeasuredInASmallerImage) {
  RemovedRectangle rectangle({5, 5, 150, 110});
  EXPECT_FALSE(rectangle.measure()->is_visible());
  rectangle.show_object(rectangle.images.result);
  EXPECT_GT(rectangle.measure()->similarity, 0.9);
}

TEST(Residue, DoesNotCountTheBorder) {
  RemovedRectangle rectangle;
  rectangle.background(rectangle.box).copyTo(rectangle.images.input(rectangle.box));
  const cv::Rect inner(rectangle.box.x + 2, rectangle.box.y + 2, rectangle.box.width - 4, rectangle.box.height - 4);
  rectangle.object(inner).copyTo(rectangle.images.input(inner));
  EXPECT_LT(rectangle.measure()->similarity, 0.15) << "the silhouette is 2 px too large";
}

TEST(Residue, OfAnObjectWithoutTextureIsUnknown) {
  RemovedRectangle rectangle;
  rectangle.images.input(rectangle.box) = cv::Vec3b(80, 90, 100);
  rectangle.images.result(rectangle.box) = cv::Vec3b(80, 90, 100);
  ASSERT_TRUE(rectangle.measure());
  EXPECT_FALSE(rectangle.measure()->is_visible());
  rectangle.images.removed(rectangle.box) = 0;
  EXPECT_TRUE(rectangle.measure()->is_visible()) << "nothing of it was removed";
}

TEST(Residue, OfAnObjectThatIsNotRemovedIsComplete) {
  RemovedRectangle rectangle;
  rectangle.show_object(rectangle.images.result);
  rectangle.images.removed(rectangle.box) = 0;
  EXPECT_EQ(rectangle.measure()->unmasked, 1);
  EXPECT_EQ(rectangle.measure()->score(), 1);
}

TEST(Residue, OfATinyObjectIsNotMeasured) {
  EXPECT_FALSE(RemovedRectangle({40, 30, 6, 6}).measure());
  EXPECT_FALSE(measure_residue(RemovedRectangle().images, cv::Mat1b(kHeightPx, kWidthPx, uchar{0})));
}

TEST(Residue, IsMeasuredWhereTheScanShowsTheObject) {
  RemovedRectangle rectangle;
  const cv::Rect left(rectangle.box.x, rectangle.box.y, rectangle.box.width / 2, rectangle.box.height);
  rectangle.object(left).copyTo(rectangle.images.result(left));  // a static surface that hides half of the object
  EXPECT_TRUE(rectangle.measure()->is_visible());
  rectangle.images.things = cv::Mat1b(kHeightPx, kWidthPx, uchar{255});
  rectangle.images.things(left) = 0;
  EXPECT_FALSE(rectangle.measure()->is_visible());
}

TEST(Residue, IsNotMadeOfPixelsThatWereNotCopied) {
  RemovedRectangle rectangle;
  rectangle.show_object(rectangle.images.result);
  rectangle.images.copied(rectangle.box) = 0;
  EXPECT_EQ(rectangle.measure()->similarity, 0);
}

}  // namespace
}  // namespace dvi::objects
