#include "dvi/synthesize/surrounding_ranges.h"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/image/region.h"

namespace dvi::synthesize {
namespace {

using harmonize::Kind;

// A street, dark on the left half and bright on the right, with a hole in its middle.
harmonize::FilledFrame street(const cv::Rect& hole) {
  harmonize::FilledFrame frame;
  frame.color = cv::Mat3f(200, 400, cv::Vec3f::all(60));
  frame.color.colRange(200, 400).setTo(cv::Vec3f::all(120));
  frame.kind = cv::Mat1b(frame.color.size(), static_cast<uchar>(Kind::original));
  frame.kind(hole).setTo(static_cast<uchar>(Kind::interpolated));
  return frame;
}

ColorRange range_at(const harmonize::FilledFrame& frame, cv::Point p) {
  const Region region(cv::Mat1b(frame.kind == static_cast<uchar>(Kind::interpolated)));
  return find_surrounding_ranges(frame, region).at(static_cast<std::size_t>(region.index(p)));
}

TEST(SurroundingRanges, AreThoseOfTheNearestKnownPixels) {
  const harmonize::FilledFrame frame = street({100, 50, 200, 100});
  EXPECT_EQ(range_at(frame, {102, 100}).high[0], 60);
  EXPECT_EQ(range_at(frame, {297, 100}).low[0], 120);
  EXPECT_EQ(range_at(frame, {200, 100}).low[0], 60) << "in the middle, of both sides";
  EXPECT_EQ(range_at(frame, {200, 100}).high[0], 120);
}

TEST(SurroundingRanges, AreNotThoseOfFewCopies) {
  harmonize::FilledFrame frame = street({100, 50, 200, 100});
  const cv::Rect copy(170, 98, 20, 4);
  frame.kind(copy).setTo(static_cast<uchar>(Kind::copied));
  frame.color(copy).setTo(cv::Vec3f::all(5));
  for (const cv::Point p : {cv::Point(180, 106), cv::Point(180, 94), cv::Point(195, 100), cv::Point(160, 110)})
    EXPECT_GE(range_at(frame, p).high[0], 60) << p;
}

TEST(SurroundingRanges, HaveAllColorsWithoutKnownPixels) {
  const harmonize::FilledFrame frame = street({0, 0, 400, 200});
  EXPECT_EQ(range_at(frame, {200, 100}).low[0], 0);
  EXPECT_EQ(range_at(frame, {200, 100}).high[0], 255);
}

}  // namespace
}  // namespace dvi::synthesize
