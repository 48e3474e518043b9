#include "dvi/harmonize/packed_frame.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::harmonize {
namespace {

const cv::Size kSize(40, 30);

cv::Mat3b make_image() {
  cv::Mat3b out(kSize);
  cv::RNG(1).fill(out, cv::RNG::UNIFORM, 0, 256);
  return out;
}

/// A frame with random content in its hole.
FilledFrame make_frame(const cv::Mat1b& mask) {
  cv::RNG random(2);
  cv::Mat1f depth(kSize);
  random.fill(depth, cv::RNG::UNIFORM, 1, 50);
  FilledFrame out = make_unfilled_frame(make_image(), mask, depth, {0.9F, 1, 1.1F});
  const auto fill = [&](cv::Mat field, int end) {
    cv::Mat content(field.size(), field.type());
    random.fill(content, cv::RNG::UNIFORM, 0, end);
    content.copyTo(field, mask);
  };
  fill(out.color, 256);
  fill(out.kind, 5);
  fill(out.provenance, 65536);
  fill(out.used, 256);
  fill(out.confidence, 256);
  return out;
}

bool is_equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(PackedFrame, RestoresTheFrame) {
  cv::Mat1b mask(kSize, uchar{0});
  mask(cv::Rect(0, 0, 7, 4)) = 255;
  mask(cv::Rect(20, 12, 20, 18)) = 255;
  for (const cv::Mat1b& hole : {mask, cv::Mat1b(kSize, uchar{0}), cv::Mat1b(kSize, uchar{255})}) {
    const FilledFrame frame = make_frame(hole);
    const FilledFrame out = PackedFrame(frame).unpack(make_image());
    EXPECT_TRUE(is_equal(out.color, frame.color));
    EXPECT_TRUE(is_equal(out.mask, frame.mask));
    EXPECT_TRUE(is_equal(out.kind, frame.kind));
    EXPECT_TRUE(is_equal(out.provenance, frame.provenance));
    EXPECT_TRUE(is_equal(out.used, frame.used));
    EXPECT_TRUE(is_equal(out.confidence, frame.confidence));
    EXPECT_TRUE(is_equal(out.depth, frame.depth));
    EXPECT_EQ(out.gain, frame.gain);
  }
}

TEST(PackedFrame, TakesMemoryForThePixelsOfTheHole) {
  cv::Mat1b mask(kSize, uchar{0});
  const std::size_t empty = PackedFrame(make_frame(mask)).bytes();
  EXPECT_EQ(empty, 5U * 40 * 30);  // depth and mask
  mask(cv::Rect(0, 0, 10, 10)) = 255;
  EXPECT_NEAR(static_cast<double>(PackedFrame(make_frame(mask)).bytes() - empty), 100 * 24, 100);
}

}  // namespace
}  // namespace dvi::harmonize
