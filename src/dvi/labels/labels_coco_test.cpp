#include <fmt/format.h>

#include "dvi/drive/outline.h"
#include "dvi/labels/labels.h"
#include "dvi/testing/image_drive.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const cv::Size kSize(8, 6);

Drive drive_of_three() { return make_image_drive(3, kSize, 10); }

// Returns the pixels of a label's outline.
cv::Mat1b draw_label(const Label& label) {
  cv::Mat1b mask(kSize, uchar{0});
  draw(label.instance.value(), mask);
  return mask;
}

cv::Mat1b draw_parts(const std::vector<cv::Rect>& parts) {
  cv::Mat1b mask(kSize, uchar{0});
  for (const cv::Rect& part : parts) mask(part) = 255;
  return mask;
}

double difference(const cv::Mat1b& a, const cv::Mat1b& b) { return cv::norm(a, b, cv::NORM_INF); }

// Returns a file with these annotations of images 1 to 3, which are the frames 000 to 002.
std::string coco(const std::string& annotations) {
  return R"({"info":{},"images":[{"id":1,"file_name":"front/000.jpg","width":8,"height":6},{"id":2,"file_name":"front/001.jpg"},
    {"id":3,"file_name":"front\\002.png"}],"categories":[{"id":7,"name":"Car"}],"annotations":[)" +
         annotations + "]}";
}

TEST(Coco, ReadsPolygonsRunsAndBoxes) {
  const TestFolder folder;
  const auto file = folder.write("coco.json", coco(R"(
    {"id":1,"image_id":1,"category_id":7,"segmentation":[[1,1,4,1,4,3,1,3],[5,4,9,4,9,9,5,9],[2,2]],"bbox":[0,0,8,6],
     "attributes":{"track_id":5,"occluded":false}},
    {"id":2,"image_id":1,"category_id":8,"iscrowd":1,"segmentation":{"size":[6,8],"counts":[7,2,4,2,33]},"track_id":9},
    {"id":3,"image_id":3,"category_id":7,"segmentation":{"size":[6,8],"counts":"7240m0"},"instance_id":"six"},
    {"id":4,"image_id":3,"category_id":7,"segmentation":[],"bbox":[-2,1.5,4,2],"instance_id":6},
    {"id":5,"image_id":3,"category_id":7,"segmentation":null,"bbox":[8,2,4,4]})"));
  const FileLabels read = read_labels(file, drive_of_three());
  const FrameLabels& labels = read.frames;
  ASSERT_EQ(labels[0].size(), 2U);
  EXPECT_EQ(labels[0][0].type, "car");
  EXPECT_EQ(labels[0][0].track, 5);
  EXPECT_EQ(difference(draw_label(labels[0][0]), draw_parts({{1, 1, 3, 2}, {5, 4, 3, 2}})), 0);
  EXPECT_EQ(labels[0][1].type, "class 8");
  EXPECT_EQ(labels[0][1].track, 9);
  EXPECT_EQ(difference(draw_label(labels[0][1]), draw_parts({{1, 1, 2, 2}})), 0);
  EXPECT_TRUE(labels[1].empty());
  ASSERT_EQ(labels[2].size(), 2U);
  EXPECT_EQ(labels[2][0].track, -1);
  EXPECT_EQ(labels[2][0].instance->runs, labels[0][1].instance->runs);
  EXPECT_EQ(labels[2][1].track, 6);
  EXPECT_EQ(*labels[2][1].rect, cv::Rect2d(0, 1.5, 2, 2)) << "it is clipped at the border";
  EXPECT_THAT(read.warnings, ElementsAre("coco.json has 1 object outside the image, the first in frame 002"));
  EXPECT_TRUE(read.frames_after_last.frames.empty()) << "an image without annotations is labeled";
}

TEST(Coco, UsesTheBoxIfTheSegmentationIsEmpty) {
  const TestFolder folder;
  for (const char* empty : {"[[]]", "[]", "null", "[[1,2]]", "[[],[1,1,2,2]]"}) {
    const auto file = folder.write(
        "coco.json", coco(fmt::format(R"({{"id":1,"image_id":1,"category_id":7,"segmentation":{},"bbox":[1,2,3,4]}})", empty)));
    const FileLabels read = read_labels(file, drive_of_three());
    ASSERT_EQ(read.frames[0].size(), 1U) << empty;
    EXPECT_EQ(read.frames[0][0].rect.value_or(cv::Rect2d()), cv::Rect2d(1, 2, 3, 4)) << empty;
  }
}

TEST(Coco, ScalesCoordinatesInFractionsOfTheImage) {
  const TestFolder folder;
  Drive drive = drive_of_three();
  drive.camera.width = 80, drive.camera.height = 60;
  const auto file = folder.write("coco.json", R"({"images":[{"id":1,"file_name":"000.png"}],"annotations":[
    {"id":1,"image_id":1,"category_id":7,"bbox":[0.25,0.5,0.125,0.25]},
    {"id":2,"image_id":1,"category_id":7,"segmentation":[[0,0,0.5,0,0.5,0.5,0,0.5]]}]})");
  const FileLabels read = read_labels(file, drive);
  ASSERT_EQ(read.frames[0].size(), 2U);
  EXPECT_EQ(*read.frames[0][0].rect, cv::Rect2d(20, 30, 10, 15));
  cv::Mat1b mask(60, 80, uchar{0});
  draw(*read.frames[0][1].instance, mask);
  EXPECT_EQ(cv::countNonZero(mask), 40 * 30);
  EXPECT_THAT(read.warnings, testing::Contains(HasSubstr("read as fractions of the image")));
  const auto one = folder.write("one.json", R"({"images":[{"id":1,"file_name":"000.png"}],"annotations":[
    {"id":1,"image_id":1,"category_id":7,"bbox":[0,0,1,1]},{"id":2,"image_id":1,"category_id":7,"bbox":[0,0,2,2]}]})");
  EXPECT_EQ(*read_labels(one, drive).frames[0][0].rect, cv::Rect2d(0, 0, 1, 1)) << "a box of one pixel among larger ones";
}

TEST(Coco, RecognizesPolygonsThroughPixelCentersByTheirArea) {
  const TestFolder folder;
  // The corners are the contour of the 4 x 3 pixels from (1, 1) to (4, 3) by findContours, and the edges of 3 x 2 pixels.
  for (const auto& [area, pixels] : {std::pair("12", cv::Rect(1, 1, 4, 3)), std::pair("6.0", cv::Rect(1, 1, 3, 2))}) {
    const auto file = folder.write(
        "coco.json",
        coco(fmt::format(R"({{"id":1,"image_id":1,"category_id":7,"area":{},"segmentation":[[1,1,4,1,4,3,1,3]]}})", area)));
    EXPECT_EQ(difference(draw_label(read_labels(file, drive_of_three()).frames[0].at(0)), draw_parts({pixels})), 0) << area;
  }
}

TEST(Coco, MatchesNamesChangedByTools) {
  const TestFolder folder;
  const auto file = folder.write("coco.json", R"({"images":[{"id":1,"file_name":"001_png.rf.0af3.jpg"}],"annotations":[
    {"id":1,"image_id":1,"category_id":7,"bbox":[1,2,3,4]}]})");
  const FileLabels read = read_labels(file, drive_of_three());
  EXPECT_EQ(read.frames[1].size(), 1U);
  EXPECT_THAT(read.warnings, testing::Contains(HasSubstr("coco.json: names are matched")));
  EXPECT_THAT(read.warnings, testing::Contains("coco.json has no labels for 1 of 3 frames, in which nothing is removed: 10"));
}

TEST(Coco, DistinguishesCamerasByTheirFolders) {
  const TestFolder folder;
  const std::string box = R"("category_id":1,"bbox":[1,1,2,2])";
  const auto images = [](const char* left) {
    return fmt::format(R"({{"images":[{{"id":"a","file_name":"run/front/000.png"}},{{"id":"b","file_name":"run/{}/000.png",
      "width":3,"height":3}}],"annotations":[)",
                       left);
  };
  const auto both = folder.write(
      "both.json", images("left") + "{\"id\":1,\"image_id\":\"a\"," + box + "},{\"id\":2,\"image_id\":\"b\"," + box + "}]}");
  EXPECT_EQ(read_labels(both, drive_of_three()).frames[0].size(), 1U);
  Drive other = drive_of_three();
  other.camera_name = "back";
  EXPECT_THAT(input_error([&] { read_labels(both, other); }),
              AllOf(HasSubstr("two images called 000"), HasSubstr("left/000.png")));
}

TEST(Coco, WarnsOfFramesThatTheDriveDoesNotHave) {
  const TestFolder folder;
  Drive drive = drive_of_three();
  drive.frames.pop_back();
  const auto file = folder.write("coco.json", coco(R"({"id":4,"image_id":3,"category_id":7,"bbox":[1,1,2,2]})"));
  EXPECT_THAT(read_labels(file, drive).warnings, ElementsAre("coco.json labels 1 frames that the drive does not have, first "
                                                             "002: its frames are 002, those of the drive are 000 to 001"));
}

TEST(Coco, ReportsTheMalformedAnnotation) {
  const TestFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error([&] { read_labels(folder.write("c.json", text), drive_of_three()); });
  };
  const auto annotation = [&](const std::string& rest) {
    return error(coco("{\"id\":42,\"image_id\":1,\"category_id\":7," + rest + "}"));
  };
  const auto place = AllOf(HasSubstr("c.json"), HasSubstr("annotation 42: "));
  const auto expect = [&](const std::string& rest, const char* what) {
    EXPECT_THAT(annotation(rest), AllOf(place, HasSubstr(what))) << rest;
  };
  expect(R"("segmentation":{"size":[60,80],"counts":[4800]})", "80x60 pixels, but the drive's images are 8x6");
  expect(R"("segmentation":{"size":[6,8],"counts":[47]})", "does not fill the image");
  expect(R"("segmentation":{"size":[6,8],"counts":[-1,49]})", "a run is not a whole number");
  expect(R"("segmentation":{"size":[6,8],"counts":[1e9]})", "a run is not a whole number");
  expect(R"("segmentation":{"size":[6,8],"counts":"4Z"})", "outline is truncated");
  expect(R"("segmentation":{"counts":[48]})", "size");
  expect(R"("segmentation":[[1,2,3,4,5]])", "not a list of pairs");
  expect(R"("segmentation":[1,2,3,4,5,6])", "not a list of pairs");
  expect(R"("segmentation":[[1,2,3,4,5,1e7]])", "far outside");
  expect(R"("segmentation":[[1,2,3,4,5,"x"]])", "must be number");
  expect(R"("bbox":[1,2,3])", "x, y, width, height");
  expect(R"("bbox":[1,2,-3,4])", "negative");
  expect(R"("area":3)", "neither a segmentation nor a bbox");
  EXPECT_THAT(error(coco(R"({"id":42,"image_id":4,"category_id":7,"bbox":[1,1,2,2]})")),
              AllOf(place, HasSubstr("unknown image 4")));
  EXPECT_THAT(error(R"({"images":[{"id":1,"file_name":"000.png","width":9,"height":6}],"annotations":[]})"),
              HasSubstr("000.png is 9x6 pixels, but the drive's images are 8x6"));
  EXPECT_THAT(error(R"({"images":[{"id":1,"file_name":"x.png"}],"annotations":[]})"),
              HasSubstr("no image of the drive: its first image is x.png, that of the drive is 000"));
  EXPECT_THAT(error(R"({"images":[{"id":1,"file_name":"000.png"},{"id":1,"file_name":"001.png"}],"annotations":[]})"),
              HasSubstr("two images have the id 1"));
  EXPECT_THAT(error(R"({"images":[{"id":1}],"annotations":[]})"), HasSubstr("images: "));
  EXPECT_THAT(error(R"({"images":[], "annotations":[)"), HasSubstr("parse error"));
}

}  // namespace
}  // namespace dvi::labels
