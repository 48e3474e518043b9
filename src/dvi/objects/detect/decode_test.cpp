#include "dvi/objects/detect/decode.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/testing/temp_folder.h"

namespace dvi::objects {
namespace {

using testing::HasSubstr;

cv::Mat blob(const std::vector<int>& sizes, float value = 0) {
  return {static_cast<int>(sizes.size()), sizes.data(), CV_32F, cv::Scalar(value)};
}
float& at(cv::Mat& blob, int c, int y, int x) { return blob.ptr<float>(0, c)[y * blob.size[3] + x]; }

// Describes a network. All classes but sky are removed.
Description make_description(Layout layout, std::vector<std::string> classes = {"sky", "car", "person"}) {
  Description d;
  d.model = "net.onnx";
  d.file = "net.toml";
  d.input = {64, 32};
  d.layout = layout;
  for (const std::string& name : classes) d.removed.push_back(name != "sky" ? 1 : 0);
  d.classes = std::move(classes);
  d.least_pixels = 4;
  return d;
}

Detections decode_outputs(const std::vector<cv::Mat>& outputs, const Description& d, cv::Size image = {64, 32}) {
  return decode(outputs, d, fit_image(image, d));
}

void expect_whole(const Detection& d, int type, cv::Rect box) {
  EXPECT_EQ(d.type, type);
  EXPECT_EQ(d.box, box);
  EXPECT_EQ(cv::countNonZero(d.mask), box.area());
}

TEST(DecodeSemantic, ReturnsAnObjectPerPartOfARemovedClass) {
  cv::Mat logits = blob({1, 3, 32, 64});
  const auto paint = [&](int type, cv::Rect box) {
    for (int y = box.y; y < box.br().y; ++y)
      for (int x = box.x; x < box.br().x; ++x) at(logits, type, y, x) = 5;
  };
  paint(1, {3, 4, 10, 6});
  paint(1, {30, 4, 5, 5});
  paint(2, {50, 20, 3, 8});
  paint(0, {40, 0, 8, 8});
  paint(2, {0, 0, 1, 2});  // too small
  const Detections found = decode_outputs({logits}, make_description(Layout::semantic));
  ASSERT_EQ(found.size(), 3U);
  expect_whole(found[0], 1, {3, 4, 10, 6});
  expect_whole(found[1], 1, {30, 4, 5, 5});
  expect_whole(found[2], 2, {50, 20, 3, 8});
  EXPECT_EQ(found[0].score, 1);
}

TEST(DecodeSemantic, InterpolatesCoarseLogits) {
  cv::Mat logits = blob({1, 2, 8, 16});  // cells of 4 x 4 pixels of the input, 8 x 8 of the image
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) at(logits, 1, y, x) = x >= 4 && x < 8 && y >= 2 && y < 6 ? 1.F : -1.F;
  const Detections found = decode_outputs({logits}, make_description(Layout::semantic, {"sky", "car"}), {128, 64});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].box, cv::Rect(32, 16, 32, 32)) << "halfway between centers";
}

TEST(DecodeSemantic, AcceptsClassMaps) {
  for (const std::vector<int>& sizes : {std::vector<int>{1, 1, 16, 32}, {1, 16, 32}, {16, 32}}) {
    cv::Mat ids = blob(sizes);
    for (int y = 2; y < 6; ++y)
      for (int x = 4; x < 10; ++x) ids.ptr<float>()[y * 32 + x] = 2;
    const Detections found = decode_outputs({ids}, make_description(Layout::semantic));
    ASSERT_EQ(found.size(), 1U);
    expect_whole(found[0], 2, {8, 4, 12, 8});
  }
}

TEST(DecodeSemantic, RejectsOtherShapes) {
  const Description d = make_description(Layout::semantic);
  const std::string text = input_error([&] { decode_outputs({blob({1, 19, 32, 64})}, d); });
  EXPECT_THAT(text, HasSubstr("its outputs are 1x19x32x64, and kind \"semantic\" with 3 classes expects 1x3xHxW"));
  EXPECT_THAT(text, HasSubstr("net.toml"));
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 100, 85}, 0.5F)}, d); }), HasSubstr("1x100x85"));
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 1000})}, d); }), HasSubstr("1x1000"));
  EXPECT_THAT(input_error([&] { decode_outputs({}, d); }), HasSubstr("expects"));
}

TEST(DecodeSemantic, DetectsNothingIfLogitsAreNan) {
  const cv::Mat logits = blob({1, 3, 32, 64}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(decode_outputs({logits}, make_description(Layout::semantic)).empty());
}

// Prototypes at a quarter of the input: the first is positive left of column 32, the second right of it.
cv::Mat halves() {
  cv::Mat prototypes = blob({1, 2, 8, 16});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) {
      at(prototypes, 0, y, x) = x < 8 ? 1.F : -1.F;
      at(prototypes, 1, y, x) = x < 8 ? -1.F : 1.F;
    }
  return prototypes;
}

cv::Mat yolov5_rows(const std::vector<std::vector<float>>& rows) {
  cv::Mat out = blob({1, static_cast<int>(rows.size()), static_cast<int>(rows.front().size())});
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::copy(rows[i].begin(), rows[i].end(), out.ptr<float>(0, static_cast<int>(i)));
  return out;
}

TEST(DecodeYolov5, DrawsTheOutlineFromThePrototypesInTheBox) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // x, y, width, height, objectness, sky, car, person, two coefficients
  const cv::Mat rows = yolov5_rows({
      {32, 10, 20, 12, 0.9F, 0, 1, 0, 1, 0},       // left half of a car
      {33, 10, 20, 12, 0.8F, 0, 1, 0, 1, 0},       // the same car again
      {32, 10, 20, 12, 0.7F, 0, 0, 1, 0, 1},       // right half of a person
      {10, 20, 8, 8, 0.9F, 1, 0, 0, 1, 0},         // sky
      {10, 20, 8, 8, 0.4F, 0, 0.6F, 0, 1, 0},      // score too small: 0.24
      {10, 20, 8, 8, 0.9F, 0, 1, 0, -1, 0},        // an empty outline
      {500, 20, 8, 8, 0.9F, 0, 1, 0, 1, 0},        // outside
      {nan, 20, 8, 8, 0.9F, 0, 1, 0, 1, 0},        // NaN
      {10, 20, 8, 8, nan, 0, 1, 0, 1, 0},          //
      {10, 20, -8, 8, 0.9F, 0, 1, 0, 1, 0},        // negative size
      {1e30F, 20, 1e30F, 8, 0.9F, 0, 1, 0, 1, 0},  // left of it, and large
  });
  const Detections found = decode_outputs({rows, halves()}, make_description(Layout::yolov5_seg));
  ASSERT_EQ(found.size(), 2U);
  expect_whole(found[0], 1, {22, 4, 10, 12});
  EXPECT_FLOAT_EQ(found[0].score, 0.9F);
  expect_whole(found[1], 2, {32, 4, 10, 12});
  EXPECT_EQ(decode_outputs({halves(), rows}, make_description(Layout::yolov5_seg)).size(), 2U) << "in any order";
}

TEST(DecodeYolov5, InvertsTheLetterbox) {
  const cv::Mat rows = yolov5_rows({{16, 16, 8, 8, 1, 0, 1, 0, 1, 0}});
  const Detections found =
      decode_outputs({rows, halves()}, make_description(Layout::yolov5_seg), {128, 32});  // content: 64 x 16 from row 8
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {24, 8, 16, 16});
}

TEST(DecodeYolov5, RejectsOtherShapes) {
  const Description d = make_description(Layout::yolov5_seg);
  const std::string text = input_error([&] { decode_outputs({blob({1, 10, 85}), halves()}, d); });
  EXPECT_THAT(text, HasSubstr("its outputs are 1x10x85, 1x2x8x16, and kind \"yolov5-seg\" with 3 classes expects 1xNx(8 + M)"));
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 10, 10})}, d); }), HasSubstr("1xMxHxW"));
}

struct Head {
  cv::Mat boxes, classes, coefficients;
};

// Strides 8 and 16; no object is detected, and every box extends by `bins` cells to each side.
Head head(int stride, const std::array<int, 4>& bins) {
  const int rows = 32 / stride, cols = 64 / stride;
  Head out{blob({1, 64, rows, cols}), blob({1, 3, rows, cols}, -20), blob({1, 2, rows, cols})};
  for (int side = 0; side < 4; ++side)
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < cols; ++x) at(out.boxes, 16 * side + bins[static_cast<std::size_t>(side)], y, x) = 60;
  return out;
}

TEST(DecodeYolov8, ReadsBoxesFromDistances) {
  Head fine = head(8, {1, 0, 2, 1}), coarse = head(16, {1, 1, 1, 1});
  at(fine.classes, 1, 1, 3) = 20;  // center 28, 12: from 20, 12 to 44, 20
  at(fine.coefficients, 0, 1, 3) = 1;
  at(coarse.classes, 2, 0, 3) = 20;  // center 56, 8: from 40, -8 to 72, 24
  at(coarse.coefficients, 1, 0, 3) = 1;
  at(coarse.classes, 0, 1, 0) = 20;  // sky
  const std::vector<cv::Mat> outputs{fine.boxes,     fine.classes,        fine.coefficients, coarse.boxes,
                                     coarse.classes, coarse.coefficients, halves()};
  const Detections found = decode_outputs(outputs, make_description(Layout::yolov8_seg));
  ASSERT_EQ(found.size(), 2U);
  const Detection& car = found[found[0].type == 1 ? 0 : 1];
  const Detection& person = found[found[0].type == 1 ? 1 : 0];
  expect_whole(car, 1, {20, 12, 12, 8});
  EXPECT_NEAR(car.score, 1, 1e-6);
  expect_whole(person, 2, {40, 0, 24, 24});
}

TEST(DecodeYolov8, DecodesDistancesBetweenBins) {
  Head fine = head(8, {1, 1, 1, 1});
  at(fine.boxes, 2, 1, 3) = 60;  // left: bins 1 and 2 alike, 1.5 cells
  at(fine.classes, 1, 1, 3) = 20;
  at(fine.coefficients, 0, 1, 3) = 1;
  const Detections found =
      decode_outputs({fine.boxes, fine.classes, fine.coefficients, halves()}, make_description(Layout::yolov8_seg));
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {16, 4, 16, 16});
}

TEST(DecodeYolov8, AcceptsBoxesAndClassesInOneMap) {
  Head fine = head(8, {1, 0, 2, 1});
  at(fine.classes, 1, 1, 3) = 20;
  at(fine.coefficients, 0, 1, 3) = 1;
  cv::Mat both = blob({1, 67, 4, 8});
  std::copy_n(fine.boxes.ptr<float>(), fine.boxes.total(), both.ptr<float>());
  std::copy_n(fine.classes.ptr<float>(), fine.classes.total(), both.ptr<float>(0, 64));
  const Detections found = decode_outputs({halves(), fine.coefficients, both}, make_description(Layout::yolov8_seg));
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {20, 12, 12, 8});
}

TEST(DecodeYolov8, RejectsTheWholeHeadAndMissingMaps) {
  const Description d = make_description(Layout::yolov8_seg);
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 39, 40}), halves()}, d); }),
              HasSubstr("the head cut before its boxes"));
  const Head fine = head(8, {1, 1, 1, 1});
  EXPECT_THAT(input_error([&] { decode_outputs({fine.boxes, fine.classes, halves()}, d); }),
              HasSubstr("expects for each stride"));
  EXPECT_THAT(input_error([&] { decode_outputs({fine.boxes, fine.classes, fine.coefficients}, d); }), HasSubstr("prototypes"));
}

}  // namespace
}  // namespace dvi::objects
