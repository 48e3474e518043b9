#include "dvi/metrics/look.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/core/threads.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/ground_pixels.h"
#include "dvi/metrics/test_result.h"
#include "dvi/metrics/texture_cells.h"

namespace dvi::metrics {
namespace {

using testing::HasSubstr;
using testing::Optional;

const cv::Size kImage(240, 200);
const cv::Rect kPart(80, 64, 80, 64);

// Rough texture whose gradients are mostly horizontal.
cv::Mat3b make_stripes() {
  Random random(3);
  cv::Mat1f noise(kImage);
  for (float& value : noise) value = static_cast<float>(random.uniform(-1, 1));
  cv::GaussianBlur(noise, noise, {3, 15}, 0.7, 4);
  cv::Mat3b image(kImage);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) image(y, x) = cv::Vec3b::all(cv::saturate_cast<uchar>(100 + 120 * noise(y, x)));
  return image;
}

LookImages make_images(uchar kind = 4) {
  LookImages images{make_stripes(), cv::Mat1b(kImage, uchar{0}), {}};
  images.kind(kPart) = kind;
  return images;
}

TEST(LookOfAFrame, OfTheTruthIsNearZero) {
  for (const uchar kind : {uchar{3}, uchar{4}, uchar{6}}) {
    const LookFrame frame = measure_look(make_images(kind));
    EXPECT_EQ(frame.sums.pixels, static_cast<std::size_t>(kPart.area()));
    EXPECT_EQ(frame.sums.image_pixels, static_cast<std::size_t>(kImage.area()));
    EXPECT_THAT(frame.sums.look(), Optional(testing::Lt(0.15)));
    EXPECT_THAT(frame.sums.blank(), Optional(0.0));
    EXPECT_THAT(frame.sums.color(), Optional(testing::Lt(2)));
    ASSERT_EQ(frame.parts.size(), 1U);
    EXPECT_EQ(frame.parts[0].box, kPart);
  }
}

TEST(LookOfAFrame, OfAFlatColorIsBlankAndLarge) {
  LookImages images = make_images();
  images.frame(kPart) = cv::Vec3b::all(100);
  const LookSums sums = measure_look(images).sums;
  EXPECT_THAT(sums.blank(), Optional(1.0));
  EXPECT_THAT(sums.texture(), Optional(testing::Gt(1)));
  EXPECT_THAT(sums.color(), Optional(testing::Lt(2)));
}

TEST(LookOfAFrame, OfAnotherColorHasAColorDistanceAndABoundary) {
  LookImages images = make_images();
  images.frame(kPart) += cv::Scalar(60, 60, 60);
  const LookSums sums = measure_look(images).sums;
  EXPECT_THAT(sums.color(), Optional(testing::AllOf(testing::Gt(50), testing::Lt(60))));
  EXPECT_THAT(sums.boundary(), Optional(testing::Gt(1)));
  EXPECT_THAT(sums.texture(), Optional(testing::Lt(0.15)));
  EXPECT_NEAR(*sums.look(), *sums.texture() + *sums.boundary(), 1e-12);
  EXPECT_NEAR(*sums.impact(), *sums.look() * 100.0 * kPart.area() / kImage.area(), 1e-9);
}

TEST(LookOfAFrame, OfARotatedTextureHasATextureDistance) {
  LookImages images = make_images();
  cv::Mat3b rotated;
  cv::rotate(images.frame, rotated, cv::ROTATE_90_CLOCKWISE);
  rotated(cv::Rect({40, 40}, kPart.size())).copyTo(images.frame(kPart));
  const LookSums sums = measure_look(images).sums;
  EXPECT_THAT(sums.texture(), Optional(testing::Gt(0.3)));
  EXPECT_THAT(sums.blank(), Optional(0.0));
}

// Pixels beside each other differ by 1 level, and by 19 to 21 levels across the boundary.
TEST(LookOfAFrame, MeasuresTheStepsAcrossTheBoundary) {
  LookImages images = make_images();
  for (int y = 0; y < kImage.height; ++y)
    for (int x = 0; x < kImage.width; ++x)
      images.frame(y, x) = cv::Vec3b::all(static_cast<uchar>((x + y) % 2 + (kPart.contains({x, y}) ? 60 : 40)));
  const LookSums sums = measure_look(images).sums;
  EXPECT_EQ(sums.steps, 2U * (kPart.width + kPart.height));
  EXPECT_DOUBLE_EQ(sums.known_step_sum, static_cast<double>(sums.known_steps));
  EXPECT_THAT(sums.boundary(), Optional(testing::DoubleNear(std::log2((20.0 + 1) / 2), 0.01)));
}

TEST(LookOfAFrame, IsAbsentWithoutUnobservedPixelsOrSurroundings) {
  LookImages images = make_images(2);
  EXPECT_EQ(measure_look(images).sums.look(), std::nullopt);
  images.kind = 5;
  EXPECT_EQ(measure_look(images).sums.pixels, 0U) << "left empty";
  images.kind = 4;
  const LookSums sums = measure_look(images).sums;
  EXPECT_EQ(sums.pixels, static_cast<std::size_t>(kImage.area()));
  EXPECT_EQ(sums.look(), std::nullopt);
  EXPECT_EQ(sums.impact(), std::nullopt);
  EXPECT_EQ(measure_look({cv::Mat3b(1, 1), cv::Mat1b(1, 1, uchar{4}), {}}).sums.look(), std::nullopt);
  EXPECT_EQ(measure_look({cv::Mat3b(1, 1), cv::Mat1b(1, 1, uchar{0}), {}}).sums.look(), std::nullopt);
}

TEST(LookOfAFrame, IsZeroForAFlatFillInFlatSurroundings) {
  LookImages images = make_images();
  images.frame = cv::Vec3b(70, 80, 90);
  const LookSums sums = measure_look(images).sums;
  EXPECT_THAT(sums.look(), Optional(0.0));
  EXPECT_THAT(sums.blank(), Optional(0.0));
}

// The fill on the ground is compared with the ground only.
TEST(LookOfAFrame, ComparesWithTheSameSurface) {
  LookImages images = make_images();
  const cv::Rect lower(0, kPart.y + kPart.height / 2, kImage.width, kImage.height - kPart.y - kPart.height / 2);
  images.frame(lower) = cv::Vec3b::all(100);
  images.frame(kPart & lower) = cv::Vec3b::all(100);
  EXPECT_THAT(measure_look(images).sums.blank(), Optional(0.0));
  images.ground = cv::Mat1b(kImage, uchar{0});
  images.ground(lower) = 255;
  EXPECT_THAT(measure_look(images).sums.look(), Optional(testing::Lt(0.3)));
  images.frame(kPart) = cv::Vec3b::all(100);
  EXPECT_THAT(measure_look(images).sums.blank(), Optional(testing::DoubleNear(0.5, 0.1)));
}

// A camera 1.5 m above the ground with a focal length of 100 px, before a wall at 12 m.
TEST(GroundPixels, AreThoseOnThePlaneBelowTheCamera) {
  cv::Mat1w depth(200, 240, ushort{0});
  for (int y = 101; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x)
      depth(y, x) = static_cast<ushort>(std::lround(256 * std::min(12.0, 150.0 / (y - 100))));
  depth(cv::Rect(100, 150, 40, 50)) = 256 * 2;  // a box whose lower edge is at y = 175
  const cv::Mat1b ground = find_ground_pixels(depth);
  ASSERT_EQ(ground.size(), depth.size());
  EXPECT_EQ(ground(190, 20), 255);
  EXPECT_EQ(ground(120, 20), 255);
  EXPECT_EQ(ground(105, 20), 0) << "the wall";
  EXPECT_EQ(ground(155, 120), 0) << "the box";
  EXPECT_EQ(ground(50, 20), 0) << "no depth";
  EXPECT_TRUE(find_ground_pixels(cv::Mat1w(200, 240, ushort{0})).empty());
  EXPECT_TRUE(find_ground_pixels(cv::Mat1w(1, 1, ushort{256})).empty());
  EXPECT_TRUE(find_ground_pixels(cv::Mat1w(200, 240, ushort{256 * 10})).empty()) << "a wall only";
}

TEST(TextureCells, HaveTheLengthOfGradientsByOrientation) {
  cv::Mat3b ramp(32, 48);
  for (int y = 0; y < ramp.rows; ++y)
    for (int x = 0; x < ramp.cols; ++x) ramp(y, x) = cv::Vec3b::all(static_cast<uchar>(3 * x));
  cv::Mat1b sets(ramp.size(), uchar{1});
  sets(cv::Rect(32, 0, 16, 32)) = 2;
  sets(cv::Rect(32, 0, 9, 9)) = 0;
  const auto cells = collect_texture_cells(ramp, sets, 3);
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_TRUE(cells[0].empty());
  ASSERT_EQ(cells[1].size(), 4U);
  ASSERT_EQ(cells[2].size(), 2U);
  EXPECT_EQ(cells[2][0].pixels, 16U * 16 - 81);
  const TextureCell& cell = cells[1][1];
  EXPECT_EQ(cell.corner, cv::Point(16, 0));
  EXPECT_FLOAT_EQ(cell.color[0], 3 * 23.5F);
  EXPECT_NEAR(cell.texture[0], std::log2(3.25), 1e-4);
  EXPECT_NEAR(cell.texture[4], std::log2(6.25), 1e-4);
  EXPECT_NEAR(cell.texture[2], std::log2(0.25), 1e-4);
}

class LookOfAResult : public ResultFixture {
 protected:
  LookOfAResult() {
    add("a", {make_scene(kSize, 0), make_scene(kSize, 0), box(kHole), box(kHole, 4)});
    cv::Mat3b flat = make_scene(kSize, 0);
    flat(kHole) = cv::Vec3b(0, 0, 0);
    add("b", {make_scene(kSize, 0), flat, box(kHole), box(kHole, 4)});
    add("c", {make_scene(kSize, 0), make_scene(kSize, 0), box(kHole), box(kHole, 1)});
  }
  std::optional<Look> measure() const { return measure_look(folder / "out", {"a", "b", "c"}); }
};

TEST_F(LookOfAResult, HasTheWorstFramesAndParts) {
  const std::optional<Look> look = measure();
  ASSERT_TRUE(look);
  EXPECT_EQ(look->total.pixels, 2U * kHole.area());
  EXPECT_EQ(look->total.image_pixels, 3U * kSize.area());
  ASSERT_EQ(look->frames.size(), 3U);
  EXPECT_EQ(look->frames[2].sums.look(), std::nullopt);
  EXPECT_EQ(look->find_worst_frames().front().name, "b");
  const std::vector<LookPart> parts = look->find_worst_parts();
  ASSERT_EQ(parts.size(), 1U) << "the part of frame a overlaps that of frame b";
  EXPECT_EQ(parts[0].frame, "b");
  EXPECT_EQ(parts[0].box, kHole);
}

TEST_F(LookOfAResult, IsTheSameWithAnyNumberOfThreads) {
  const std::string parallel = nlohmann::json(*measure()).dump();
  const ThreadLimit one(1);
  EXPECT_EQ(nlohmann::json(*measure()).dump(), parallel);
}

TEST_F(LookOfAResult, IsInTheTableAndInJson) {
  const Evaluation evaluation = evaluate({folder / "out", {}});
  EXPECT_THAT(format_table(evaluation), HasSubstr("look of 2400 unobserved pixels: "));
  EXPECT_THAT(format_table(evaluation), HasSubstr("worst parts: frame b at 30,20 ("));
  const nlohmann::json json = nlohmann::json(evaluation)["look"];
  EXPECT_DOUBLE_EQ(json["look"], json["texture"].get<double>() + json["boundary"].get<double>());
  EXPECT_TRUE(json["per_frame"][2]["look"].is_null());
  EXPECT_EQ(json["worst_parts"][0]["box"], nlohmann::json({30, 20, 40, 30}));
  EXPECT_TRUE(nlohmann::json(Evaluation())["look"].is_null());
}

TEST_F(LookOfAResult, ScoresTheFramesOfAnotherProgram) {
  EvaluationFolders given = folders();
  given.external = {{"other", folder / "truth"}};
  const Evaluation evaluation = evaluate(given);
  ASSERT_TRUE(evaluation.look && evaluation.external.front().evaluation.look);
  EXPECT_LT(*evaluation.external.front().evaluation.look->total.look(), *evaluation.look->total.look());
}

TEST_F(LookOfAResult, IsAbsentIfAllPixelsWereObserved) {
  EXPECT_FALSE(measure_look(folder / "out", {"c"}));
  EXPECT_THAT(format_table(evaluate({folder / "out", {}})), HasSubstr("look of"));
}

TEST_F(LookOfAResult, RefusesImagesOfAnotherSize) {
  make_folder(folder / "out/depth");
  EXPECT_THAT(input_error([&] { measure(); }), HasSubstr("out/depth/"));
  for (const char* name : {"a", "b", "c"})
    media::write_png(folder / "out/depth" / (std::string(name) + ".png"), cv::Mat1w(5, 5, ushort{0}));
  EXPECT_THAT(input_error([&] { measure(); }), HasSubstr("out/depth/"));
}

}  // namespace
}  // namespace dvi::metrics
