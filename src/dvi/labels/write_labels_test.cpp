#include "dvi/labels/write_labels.h"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dvi/labels/labels.h"
#include "dvi/labels/trace_polygons.h"
#include "dvi/testing/image_drive.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

cv::Mat1b fill_polygons(const std::vector<Polygon>& polygons, cv::Size size) {
  cv::Mat1b mask(size, uchar{0});
  draw(to_outline(polygons, size), mask);
  return mask;
}

// A disk with two holes, a part within one of them, and pixels that touch at corners and the boundary.
cv::Mat1b make_difficult_mask() {
  cv::Mat1b mask(60, 90, uchar{0});
  cv::circle(mask, {30, 30}, 25, 255, cv::FILLED);
  cv::circle(mask, {24, 30}, 10, 0, cv::FILLED);
  cv::circle(mask, {44, 30}, 4, 0, cv::FILLED);
  cv::circle(mask, {24, 30}, 5, 255, cv::FILLED);
  mask(10, 70) = mask(11, 71) = mask(12, 70) = mask(11, 69) = 255;
  mask(cv::Rect(80, 50, 10, 10)) = 255;
  mask(55, 85) = 0;
  return mask;
}

double measure_iou(const cv::Mat1b& a, const cv::Mat1b& b) {
  return cv::countNonZero(a & b) / static_cast<double>(cv::countNonZero(a | b));
}

TEST(TracePolygons, AreExactWithoutSimplification) {
  const cv::Mat1b mask = make_difficult_mask();
  const std::vector<Polygon> polygons = trace_polygons(mask, 1.1);
  EXPECT_EQ(polygons.size(), 7U) << "a part per disk, four pixels, and a square";
  EXPECT_EQ(cv::countNonZero(fill_polygons(polygons, mask.size()) != mask), 0);
}

TEST(TracePolygons, AreExactForRandomMasks) {
  cv::RNG random(5);
  for (int i = 0; i < 50; ++i) {
    cv::Mat1b mask(9 + i % 4, 12 + i % 3);
    random.fill(mask, cv::RNG::UNIFORM, 0, 2);
    cv::Mat1b filled;
    cv::compare(mask, 0, filled, cv::CMP_NE);
    EXPECT_EQ(cv::countNonZero(fill_polygons(trace_polygons(mask, 1.1), mask.size()) != filled), 0) << mask;
  }
}

TEST(TracePolygons, HaveFewCornersWithinTheOverlap) {
  cv::Mat1b mask(200, 300, uchar{0});
  cv::ellipse(mask, {150, 100}, {120, 60}, 20, 0, 360, 255, cv::FILLED);
  const std::vector<Polygon> polygons = trace_polygons(mask);
  ASSERT_EQ(polygons.size(), 1U);
  EXPECT_LT(polygons[0].size(), 60U) << "fewer than a tenth of the edges";
  EXPECT_GE(measure_iou(fill_polygons(polygons, mask.size()), mask), 0.995);
  EXPECT_TRUE(trace_polygons(cv::Mat1b(4, 4, uchar{0})).empty());
}

class WrittenLabels : public testing::Test {
 protected:
  WrittenLabels() {
    drive = make_image_drive(4, {90, 60});
    labels = {{90, 60}, 4, {}};
    for (int i = 0; i < 4; ++i) labels.images.push_back({fmt::format("{:03}.png", i), i, {}});
    for (const std::size_t i : {0, 1, 3}) {  // the car is not in image 2
      const cv::Mat1b mask = make_mask(i);
      labels.images[i].objects.push_back({5, "car & trailer", trace_polygons(mask), cv::countNonZero(mask)});
    }
  }
  static cv::Mat1b make_mask(std::size_t frame) {
    cv::Mat1b mask = make_difficult_mask();
    cv::circle(mask, {60, 50}, 3 + static_cast<int>(frame), 255, cv::FILLED);
    return mask;
  }
  void expect_same(const FileLabels& read) const {
    EXPECT_TRUE(read.warnings.empty());
    for (std::size_t i = 0; i < 4; ++i) {
      cv::Mat1b drawn = draw_instances(read.frames[i], {90, 60});
      const cv::Mat1b expected = i == 2 ? cv::Mat1b(60, 90, uchar{0}) : make_mask(i);
      if (i == 2)
        EXPECT_EQ(cv::countNonZero(drawn), 0);
      else
        EXPECT_GE(measure_iou(drawn, expected), 0.99) << i;
      for (const Label& label : read.frames[i]) EXPECT_EQ(label.type, "car & trailer");
    }
  }

  TestFolder folder;
  Drive drive;
  DrawnLabels labels;
};

TEST_F(WrittenLabels, AreReadBackFromCoco) {
  write_coco(folder.path / "coco.json", labels);
  const FileLabels read = read_labels(folder.path / "coco.json", drive);
  expect_same(read);
  ASSERT_EQ(read.frames[0].size(), 1U) << "all parts are one object";
  EXPECT_EQ(read.frames[0][0].track, 5);
}

TEST_F(WrittenLabels, AreReadBackFromCvat) {
  write_cvat(folder.path / "annotations.xml", labels);
  expect_same(read_labels(folder.path / "annotations.xml", drive));
}

}  // namespace
}  // namespace dvi::labels
