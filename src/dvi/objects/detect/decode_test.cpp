#include "dvi/objects/detect/decode.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/testing/temp_folder.h"

namespace dvi::objects {
namespace {

using testing::HasSubstr;

Tensor blob(const std::vector<int>& sizes, float value = 0) {
  std::size_t count = 1;
  for (const int size : sizes) count *= static_cast<std::size_t>(size);
  return {"out", sizes, std::vector<float>(count, value), false};
}
float& at(Tensor& tensor, int c, int y, int x) { return tensor.plane(c)(y, x); }

// Describes a network. All classes but sky are removed.
Description make_description(Layout layout, std::vector<std::string> classes = {"sky", "car", "person"}) {
  Description d;
  d.model = "net.onnx";
  d.input = {64, 32};
  d.layout = layout;
  for (const std::string& name : classes) d.removed.push_back(name != "sky" ? 1 : 0);
  d.classes = std::move(classes);
  d.least_pixels = 4;
  return d;
}

Detections decode_outputs(const std::vector<Tensor>& outputs, const Description& d, cv::Size image = {64, 32}) {
  return decode(outputs, d, fit_image(image, d));
}

void expect_whole(const Detection& d, int type, cv::Rect box) {
  EXPECT_EQ(d.type, type);
  EXPECT_EQ(d.box, box);
  EXPECT_EQ(cv::countNonZero(d.mask), box.area());
}

TEST(DecodeSemantic, ReturnsAnObjectPerPartOfARemovedClass) {
  Tensor logits = blob({1, 3, 32, 64});
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
  Tensor logits = blob({1, 2, 8, 16});  // cells of 4 x 4 pixels of the input, 8 x 8 of the image
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) at(logits, 1, y, x) = x >= 4 && x < 8 && y >= 2 && y < 6 ? 1.F : -1.F;
  const Detections found = decode_outputs({logits}, make_description(Layout::semantic, {"sky", "car"}), {128, 64});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].box, cv::Rect(32, 16, 32, 32)) << "halfway between centers";
}

TEST(DecodeSemantic, AcceptsClassMaps) {
  for (const std::vector<int>& sizes : {std::vector<int>{1, 1, 16, 32}, {1, 16, 32}, {16, 32}}) {
    Tensor ids = blob(sizes);
    for (int y = 2; y < 6; ++y)
      for (int x = 4; x < 10; ++x) ids.values[static_cast<std::size_t>(y * 32 + x)] = 2;
    const Detections found = decode_outputs({ids}, make_description(Layout::semantic));
    ASSERT_EQ(found.size(), 1U);
    expect_whole(found[0], 2, {8, 4, 12, 8});
  }
}

TEST(DecodeSemantic, RejectsOtherShapes) {
  const Description d = make_description(Layout::semantic);
  const std::string text = input_error([&] { decode_outputs({blob({1, 19, 32, 64})}, d); });
  EXPECT_THAT(text, HasSubstr("its outputs are out 1x19x32x64, and kind \"semantic\" with 3 classes expects 1x3xHxW"));
  EXPECT_THAT(text, HasSubstr("MODEL.toml"));
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 100, 85}, 0.5F)}, d); }), HasSubstr("1x100x85"));
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 1000})}, d); }), HasSubstr("1x1000"));
  EXPECT_THAT(input_error([&] { decode_outputs({}, d); }), HasSubstr("expects"));
}

TEST(DecodeSemantic, DetectsNothingIfLogitsAreNan) {
  const Tensor logits = blob({1, 3, 32, 64}, std::numeric_limits<float>::quiet_NaN());
  EXPECT_TRUE(decode_outputs({logits}, make_description(Layout::semantic)).empty());
}

// Prototypes at a quarter of the input: the first is positive left of column 32, the second right of it.
Tensor halves() {
  Tensor prototypes = blob({1, 2, 8, 16});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x) {
      at(prototypes, 0, y, x) = x < 8 ? 1.F : -1.F;
      at(prototypes, 1, y, x) = x < 8 ? -1.F : 1.F;
    }
  return prototypes;
}

Tensor yolov5_rows(const std::vector<std::vector<float>>& rows) {
  Tensor out = blob({1, static_cast<int>(rows.size()), static_cast<int>(rows.front().size())});
  for (std::size_t i = 0; i < rows.size(); ++i)
    std::copy(rows[i].begin(), rows[i].end(), out.values.begin() + static_cast<std::ptrdiff_t>(i * rows[i].size()));
  return out;
}

TEST(DecodeYolov5, DrawsTheOutlineFromThePrototypesInTheBox) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // x, y, width, height, objectness, sky, car, person, two coefficients
  const Tensor rows = yolov5_rows({
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
  const Detections found = decode_outputs({rows, halves()}, make_description(Layout::yolov5));
  ASSERT_EQ(found.size(), 2U);
  expect_whole(found[0], 1, {22, 4, 10, 12});
  EXPECT_FLOAT_EQ(found[0].score, 0.9F);
  expect_whole(found[1], 2, {32, 4, 10, 12});
  EXPECT_EQ(decode_outputs({halves(), rows}, make_description(Layout::yolov5)).size(), 2U) << "in any order";
}

TEST(DecodeYolov5, InvertsTheLetterbox) {
  const Tensor rows = yolov5_rows({{16, 16, 8, 8, 1, 0, 1, 0, 1, 0}});
  const Detections found =
      decode_outputs({rows, halves()}, make_description(Layout::yolov5), {128, 32});  // content: 64 x 16 from row 8
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {24, 8, 16, 16});
}

TEST(DecodeYolov5, RejectsOtherShapes) {
  const Description d = make_description(Layout::yolov5);
  const std::string text = input_error([&] { decode_outputs({blob({1, 10, 85}), halves()}, d); });
  EXPECT_THAT(
      text,
      HasSubstr("its outputs are out 1x10x85, out 1x2x8x16, and kind \"yolov5\" with 3 classes expects 1xNx8, or 1xNx(8 + M)"));
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 10, 10})}, d); }), HasSubstr("1xMxHxW"));
}

struct Head {
  Tensor boxes, classes, coefficients;
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
  const std::vector<Tensor> outputs{fine.boxes,     fine.classes,        fine.coefficients, coarse.boxes,
                                    coarse.classes, coarse.coefficients, halves()};
  const Detections found = decode_outputs(outputs, make_description(Layout::yolov8));
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
      decode_outputs({fine.boxes, fine.classes, fine.coefficients, halves()}, make_description(Layout::yolov8));
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {16, 4, 16, 16});
}

TEST(DecodeYolov8, AcceptsBoxesAndClassesInOneMap) {
  Head fine = head(8, {1, 0, 2, 1});
  at(fine.classes, 1, 1, 3) = 20;
  at(fine.coefficients, 0, 1, 3) = 1;
  Tensor both = blob({1, 67, 4, 8});
  std::copy(fine.classes.values.begin(), fine.classes.values.end(),
            std::copy(fine.boxes.values.begin(), fine.boxes.values.end(), both.values.begin()));
  const Detections found = decode_outputs({halves(), fine.coefficients, both}, make_description(Layout::yolov8));
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {20, 12, 12, 8});
}

TEST(DecodeYolov8, RejectsMissingMaps) {
  const Description d = make_description(Layout::yolov8);
  EXPECT_THAT(input_error([&] { decode_outputs({blob({1, 39, 40}), halves()}, d); }),
              HasSubstr("expects 1x7xN, or 1x(7 + M)xN"));
  const Head fine = head(8, {1, 1, 1, 1});
  EXPECT_THAT(input_error([&] { decode_outputs({fine.boxes, fine.classes, halves()}, d); }),
              HasSubstr("the maps of the head before its boxes are decoded"));
  EXPECT_THAT(input_error([&] { decode_outputs({fine.boxes, fine.coefficients}, d); }), HasSubstr("the maps of the head"));
}

// Columns of center, size, scores of sky, car, and person, and coefficients.
Tensor yolov8_columns(const std::vector<std::vector<float>>& boxes) {
  const int numbers = static_cast<int>(boxes.front().size()), count = static_cast<int>(boxes.size());
  Tensor out = blob({1, numbers, count});
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < numbers; ++k) out.plane(0)(k, i) = boxes[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  return out;
}

TEST(DecodeYolov8, ReadsDecodedBoxes) {
  const Tensor columns = yolov8_columns({{32, 10, 20, 12, 0, 0.9F, 0, 1, 0},
                                         {33, 10, 20, 12, 0, 0.8F, 0, 1, 0},
                                         {10, 20, 8, 8, 0.9F, 0, 0, 1, 0},
                                         {32, 10, 20, 12, 0, 0, 0.5F, 0, 1}});
  const Detections found = decode_outputs({columns, halves()}, make_description(Layout::yolov8));
  ASSERT_EQ(found.size(), 2U);
  expect_whole(found[0], 1, {22, 4, 10, 12});
  EXPECT_FALSE(found[0].is_box);
  expect_whole(found[1], 2, {32, 4, 10, 12});
}

TEST(DecodeYolov8, WithoutPrototypesReturnsBoxes) {
  const Detections found = decode_outputs({yolov8_columns({{32, 10, 20, 12, 0, 0.9F, 0}})}, make_description(Layout::yolov8));
  ASSERT_EQ(found.size(), 1U);
  expect_whole(found[0], 1, {22, 4, 20, 12});
  EXPECT_TRUE(found[0].is_box);
}

TEST(DecodeNms, ReadsCornersInPixelsAndShares) {
  const std::vector<std::vector<float>> pixels{
      {22, 4, 42, 16, 0.9F, 1, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 0}, {0, 8, 8, 16, 0.1F, 2, 1, 0}};
  const Detections masks = decode_outputs({yolov5_rows(pixels), halves()}, make_description(Layout::nms));
  ASSERT_EQ(masks.size(), 1U);
  expect_whole(masks[0], 1, {22, 4, 10, 12});
  const Detections boxes = decode_outputs({yolov5_rows({{0.25F, 0.5F, 0.5F, 0.75F, 0.9F, 2}})}, make_description(Layout::nms));
  ASSERT_EQ(boxes.size(), 1U);
  expect_whole(boxes[0], 2, {16, 16, 16, 8});
  Tensor numbered = yolov5_rows({{0, 8, 8, 16, 16, 1, 0.9F}});
  numbered.shape = {1, 7};
  const Detections yolov7 = decode_outputs({numbered}, make_description(Layout::nms));
  ASSERT_EQ(yolov7.size(), 1U);
  expect_whole(yolov7[0], 1, {8, 8, 8, 8});
}

TEST(DecodeDetr, ComparesWithTheClassOfNoObject) {
  Tensor boxes = yolov5_rows({{0.5F, 0.5F, 0.25F, 0.5F}, {0.25F, 0.5F, 0.25F, 0.5F}});
  boxes.name = "pred_boxes";
  const Detections found = decode_outputs({yolov5_rows({{0, 5, 0, 0}, {0, 5, 0, 9}}), boxes}, make_description(Layout::detr));
  ASSERT_EQ(found.size(), 1U) << "the second one shows nothing";
  expect_whole(found[0], 1, {24, 8, 16, 16});
  const Detections sigmoid = decode_outputs({yolov5_rows({{-5, -5, 1}, {-5, -5, -5}}), boxes}, make_description(Layout::detr));
  ASSERT_EQ(sigmoid.size(), 1U);
  EXPECT_NEAR(sigmoid[0].score, 0.731, 1e-3);
}

TEST(DecodeRcnn, PastesMasksIntoBoxes) {
  Tensor boxes = blob({2, 4}), labels = blob({2}), scores = blob({2}, 0.9F), masks = blob({2, 1, 4, 4}, 1);
  boxes.values = {8, 8, 24, 16, 40, 0, 48, 8};
  labels.values = {1, 2};
  labels.has_whole_numbers = true;
  for (int y = 0; y < 4; ++y) masks.plane(0)(y, 2) = masks.plane(0)(y, 3) = 0;
  const Detections found = decode_outputs({boxes, labels, scores, masks}, make_description(Layout::rcnn));
  ASSERT_EQ(found.size(), 2U);
  expect_whole(found[0], 1, {8, 8, 8, 8});
  expect_whole(found[1], 2, {40, 0, 8, 8});
  EXPECT_TRUE(decode_outputs({boxes, labels, scores}, make_description(Layout::rcnn))[0].is_box);
}

TEST(RecognizeLayout, UsesShapesAndTypes) {
  const auto recognize = [](const std::vector<Tensor>& outputs, int classes) {
    return recognize_layout(
        outputs, make_description(Layout::automatic, std::vector<std::string>(static_cast<std::size_t>(classes), "car")));
  };
  const Tensor masks = blob({1, 32, 16, 16});
  EXPECT_EQ(recognize({blob({1, 84, 100})}, 80), Layout::yolov8);
  EXPECT_EQ(recognize({blob({1, 116, 100}), masks}, 80), Layout::yolov8);
  EXPECT_EQ(recognize({masks, blob({1, 100, 117})}, 80), Layout::yolov5);
  EXPECT_EQ(recognize({blob({1, 300, 6})}, 80), Layout::nms);
  EXPECT_EQ(recognize({blob({1, 300, 38}), masks}, 80), Layout::nms);
  EXPECT_EQ(recognize({blob({1, 300, 6}, 0.5F)}, 1), Layout::yolov5) << "no class numbers";
  EXPECT_EQ(recognize({blob({1, 300, 6}, 0.5F)}, 2), Layout::detr);
  EXPECT_EQ(recognize({blob({1, 100, 92}), blob({1, 100, 4})}, 91), Layout::detr);
  EXPECT_EQ(recognize({blob({1, 19, 32, 64})}, 19), Layout::semantic);
  Tensor ids = blob({1, 32, 64});
  ids.has_whole_numbers = true;
  EXPECT_EQ(recognize({ids}, 19), Layout::semantic);
  EXPECT_THAT(input_error([&] { recognize({blob({1, 1000})}, 19); }), HasSubstr("is a classifier: its output is out 1x1000"));
  EXPECT_THAT(input_error([&] { recognize({blob({1, 56, 100})}, 80); }),
              HasSubstr("its outputs are unknown: out 1x56x100, with 80 classes; dvi reads the outputs of YOLOv5"));
  EXPECT_THAT(input_error([&] { recognize({blob({1, 84, 100})}, 0); }), HasSubstr("has no names of its classes"));
}

}  // namespace
}  // namespace dvi::objects
