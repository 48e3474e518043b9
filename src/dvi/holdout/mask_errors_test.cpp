#include "dvi/holdout/mask_errors.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "dvi/core/error.h"

namespace dvi::holdout {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 640, kHeight = 360;
const cv::Size kImage(kWidth, kHeight);

cv::Mat1b make_mask(const std::vector<cv::Rect>& boxes, cv::Size size = kImage) {
  cv::Mat1b mask(size, uchar{0});
  for (const cv::Rect& box : boxes) mask(box) = 255;
  return mask;
}

cv::Mat1b degrade(MaskErrors kind, const cv::Mat1b& silhouette) {
  return add_errors(silhouette, draw_errors(kind, {true}, silhouette.size(), 1), 0);
}

void expect_same(const cv::Mat1b& a, const cv::Mat1b& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
}

std::vector<std::size_t> find_missed(const ObjectErrors& errors) {
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < errors.missed.size(); ++i)
    if (errors.missed[i]) frames.push_back(i);
  return frames;
}

std::size_t count_boxes(const ObjectErrors& errors) {
  return static_cast<std::size_t>(
      std::count_if(errors.false_boxes.begin(), errors.false_boxes.end(), [](const auto& box) { return box.has_value(); }));
}

TEST(MaskErrors, NoneKeepsTheMask) {
  const cv::Mat1b mask = make_mask({{3, 4, 50, 20}});
  expect_same(degrade(MaskErrors::none, mask), mask);
}

TEST(MaskErrors, MissLacksAFifthOfTheFrames) {
  const std::vector<bool> visible(10000, true);
  const ObjectErrors errors = draw_errors(MaskErrors::miss, visible, kImage, 5);
  EXPECT_NEAR(static_cast<double>(find_missed(errors).size()) / 10000.0, 0.2, 0.02);
  const cv::Mat1b mask = make_mask({{3, 4, 50, 20}});
  for (std::size_t i = 0; i < 20; ++i) expect_same(add_errors(mask, errors, i), errors.missed[i] ? make_mask({}) : mask);
}

TEST(MaskErrors, BurstLacksFiveConsecutiveFramesOnce) {
  std::vector<bool> visible(20, false);
  for (std::size_t i = 6; i < 14; ++i) visible[i] = true;
  std::vector<bool> seen_first(20);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const std::vector<std::size_t> missed = find_missed(draw_errors(MaskErrors::burst, visible, kImage, seed));
    ASSERT_EQ(missed.size(), 5U);
    EXPECT_EQ(missed.back() - missed.front(), 4U);
    EXPECT_GE(missed.front(), 6U);
    EXPECT_LE(missed.back(), 13U);
    seen_first[missed.front()] = true;
  }
  EXPECT_EQ(std::count(seen_first.begin(), seen_first.end(), true), 4) << "bursts begin in frames 6 to 9";
}

TEST(MaskErrors, BurstLacksObjectsOfFewFramesEntirely) {
  EXPECT_THAT(find_missed(draw_errors(MaskErrors::burst, {false, true, false}, kImage, 1)), testing::ElementsAre(1));
  EXPECT_THAT(find_missed(draw_errors(MaskErrors::burst, {true, true, true, true, true}, kImage, 1)), testing::SizeIs(5));
  EXPECT_THAT(find_missed(draw_errors(MaskErrors::burst, {false, false}, kImage, 1)), testing::IsEmpty());
}

TEST(MaskErrors, LateLacksSmallObjects) {
  const cv::Mat1b small = make_mask({{10, 10, 31, 29}}), large = make_mask({{10, 10, 30, 30}});
  expect_same(degrade(MaskErrors::late, small), make_mask({}));
  expect_same(degrade(MaskErrors::late, large), large);
  const cv::Size half(320, 180);
  expect_same(degrade(MaskErrors::late, make_mask({{10, 10, 16, 14}}, half)), make_mask({}, half));
  expect_same(degrade(MaskErrors::late, make_mask({{10, 10, 15, 15}}, half)), make_mask({{10, 10, 15, 15}}, half));
}

TEST(MaskErrors, TightCutsDetailsOffAndErodes) {
  // The antenna is narrower than the disk. A disk rounds the corners of a box, so only its middle is exact.
  const cv::Mat1b tight = degrade(MaskErrors::tight, make_mask({{100, 100, 60, 40}, {160, 115, 10, 2}}));
  expect_same(tight(cv::Rect(90, 110, 90, 20)), make_mask({{102, 110, 56, 20}})(cv::Rect(90, 110, 90, 20)));
  expect_same(tight(cv::Rect(110, 90, 40, 60)), make_mask({{110, 102, 40, 36}})(cv::Rect(110, 90, 40, 60)));
  EXPECT_EQ(tight(102, 102), 0) << "a rounded corner";
}

TEST(MaskErrors, TightLacksObjectsSmallerThanTheDisk) {
  expect_same(degrade(MaskErrors::tight, make_mask({{100, 100, 6, 80}})), make_mask({}));
  EXPECT_GT(cv::countNonZero(degrade(MaskErrors::tight, make_mask({{100, 100, 7, 80}}))), 0);
}

TEST(MaskErrors, BoxesCoverAllPartsOfAnObject) {
  const cv::Mat1b parts = make_mask({{100, 100, 10, 10}, {150, 120, 1, 1}});
  expect_same(degrade(MaskErrors::boxes, parts), make_mask({{100, 100, 51, 21}}));
}

TEST(MaskErrors, FalseBoxesAreRareAndWithinTheImage) {
  const std::vector<bool> visible(10000, true);
  const ObjectErrors errors = draw_errors(MaskErrors::false_boxes, visible, kImage, 2);
  EXPECT_NEAR(static_cast<double>(count_boxes(errors)) / 10000.0, 0.05, 0.01);
  int largest = 0, smallest = kWidth;
  for (const std::optional<cv::Rect>& box : errors.false_boxes) {
    if (!box) continue;
    EXPECT_EQ(*box & cv::Rect({0, 0}, kImage), *box);
    largest = std::max({largest, box->width, box->height});
    smallest = std::min({smallest, box->width, box->height});
  }
  EXPECT_EQ(smallest, 40);
  EXPECT_EQ(largest, 120);
}

TEST(MaskErrors, FalseAddsABoxToTheMaskOfOneFrameAtLeast) {
  const cv::Mat1b mask = make_mask({{300, 200, 20, 10}});
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const ObjectErrors errors = draw_errors(MaskErrors::false_boxes, {true, false, true}, kImage, seed);
    ASSERT_GE(count_boxes(errors), 1U) << seed;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::optional<cv::Rect>& box = errors.false_boxes[i];
      expect_same(add_errors(mask, errors, i), box ? cv::Mat1b(mask | make_mask({*box})) : mask);
    }
  }
}

TEST(MaskErrors, FalseBoxesFitIntoSmallImages) {
  const cv::Size small(30, 20);
  const cv::Mat1b empty = make_mask({}, small);
  expect_same(degrade(MaskErrors::false_boxes, empty), make_mask({{0, 0, 30, 20}}, small));
}

TEST(MaskErrors, EmptyMasksStayEmptyButForFalseBoxes) {
  for (const auto& [kind, name] : names_of(MaskErrors{}))
    EXPECT_EQ(cv::countNonZero(degrade(kind, make_mask({}))) > 0, kind == MaskErrors::false_boxes) << name;
}

TEST(MaskErrors, DrivesWithoutFramesHaveNoErrors) {
  for (const auto& [kind, name] : names_of(MaskErrors{})) {
    const ObjectErrors errors = draw_errors(kind, {}, kImage, 1);
    EXPECT_TRUE(errors.missed.empty() && errors.false_boxes.empty()) << name;
  }
}

TEST(MaskErrors, DependOnTheSeedOnly) {
  const std::vector<bool> visible(50, true);
  for (const MaskErrors kind : {MaskErrors::miss, MaskErrors::burst, MaskErrors::false_boxes}) {
    const ObjectErrors a = draw_errors(kind, visible, kImage, 7), b = draw_errors(kind, visible, kImage, 7);
    EXPECT_EQ(a.missed, b.missed);
    EXPECT_EQ(a.false_boxes, b.false_boxes);
    const ObjectErrors other = draw_errors(kind, visible, kImage, 8);
    EXPECT_TRUE(other.missed != a.missed || other.false_boxes != a.false_boxes) << to_string(kind);
  }
}

TEST(MaskErrors, UnknownNamesAreRefusedWithTheList) {
  for (const auto& [kind, name] : names_of(MaskErrors{})) EXPECT_EQ(parse_mask_errors(name), kind);
  try {
    parse_mask_errors("blurred");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("none, miss, burst, late, tight, boxes, false"));
  }
}

}  // namespace
}  // namespace dvi::holdout
