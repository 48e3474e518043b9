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

Drive three_images() { return make_image_drive(3, {20, 12}); }

int pixels(const Label& label) {
  cv::Mat1b mask(12, 20, uchar{0});
  draw(label.instance.value(), mask);
  return cv::countNonZero(mask);
}

// The format is that of LabelMe 5 (labelme/label_file.py): two points of a rectangle in any order, center and boundary point of
// a circle.
std::string labelme(const std::string& image, const std::string& shapes, int width = 20) {
  return fmt::format(R"({{"version":"5.4.1","flags":{{}},"shapes":[{}],"imagePath":"{}","imageData":null,"imageHeight":12,
    "imageWidth":{}}})",
                     shapes, image, width);
}

std::string shape(const std::string& type, const std::string& points) {
  return fmt::format(R"({{"label":"Car","points":{},"group_id":null,"description":"","shape_type":"{}","flags":{{}}}})", points,
                     type);
}

TEST(LabelMe, ReadsAFilePerImage) {
  const TestFolder folder;
  folder.write("l/000.json", labelme("..\\\\images\\\\000.png", shape("rectangle", "[[6,7],[2,3]]") + "," +
                                                                    shape("polygon", "[[10,2],[14,2],[14,6],[10,6]]")));
  folder.write("l/001.json", labelme("001.jpg", shape("circle", "[[10,6],[14,6]]") + "," + shape("line", "[[1,1],[2,2]]") +
                                                    "," + shape("mask", "[[1,1],[4,3]]")));
  EXPECT_TRUE(holds_labels(folder.path / "l", "front"));
  const FileLabels read = read_labels(folder.path / "l", three_images());
  ASSERT_EQ(read.frames[0].size(), 2U);
  EXPECT_EQ(read.frames[0][0].type, "car");
  EXPECT_EQ(*read.frames[0][0].rect, cv::Rect2d(2, 3, 4, 4));
  EXPECT_EQ(pixels(read.frames[0][1]), 16);
  ASSERT_EQ(read.frames[1].size(), 2U);
  EXPECT_NEAR(pixels(read.frames[1][0]), CV_PI * 16, 4);
  EXPECT_EQ(*read.frames[1][1].rect, cv::Rect2d(1, 1, 3, 2));
  EXPECT_EQ(read.files.size(), 2U) << "all files are inputs of a run";
  EXPECT_THAT(read.warnings, testing::Contains(HasSubstr("1 points and lines are ignored")));
  EXPECT_THAT(read.warnings, testing::Contains(HasSubstr("1 masks have no image; their rectangles are used")));
  EXPECT_THAT(read.frames_after_last.frames, ElementsAre(2)) << "this frame has no file";
}

// The image is a PNG of 3 x 2 pixels in gray, {1, 0, 1; 1, 1, 1}, written by Pillow as LabelMe does (img_arr_to_b64).
TEST(LabelMe, ReadsMasksAndRotatedRectangles) {
  const char* mask =
      R"({"label":"Car","points":[[5,4],[7,5]],"shape_type":"mask","flags":{},"mask":"iVBORw0KGgoAAAANSUhEUgAAAAMAAAACCAAAAAC4HznGAAAAEElEQVR4nGNgZGBkYmBkAAAAHgAGlsuf7QAAAABJRU5ErkJggg=="})";
  const TestFolder folder;
  folder.write("l/000.json",
               labelme("000.png", std::string(mask) + "," + shape("oriented_rectangle", "[[10,2],[14,6],[10,10],[6,6]]")));
  const FileLabels read = read_labels(folder.path / "l", three_images());
  ASSERT_EQ(read.frames[0].size(), 2U);
  cv::Mat1b expected(12, 20, uchar{0}), drawn(12, 20, uchar{0});
  expected(cv::Rect(5, 4, 3, 2)) = 255;
  expected(4, 6) = 0;
  draw(read.frames[0][0].instance.value(), drawn);
  EXPECT_EQ(cv::countNonZero(expected != drawn), 0);
  EXPECT_EQ(pixels(read.frames[0][1]), 32);
  const std::string bad = std::string(mask).replace(std::string(mask).find("iVBO"), 4, "iV*O");
  folder.write("l/000.json", labelme("000.png", bad));
  EXPECT_THAT(input_error([&] { read_labels(folder.path / "l", three_images()); }),
              AllOf(HasSubstr("000.json"), HasSubstr("not in base64")));
}

TEST(LabelMe, ReadsOneFileForOneFrame) {
  const TestFolder folder;
  const fs::path file = folder.write("001.json", labelme("001.png", shape("rectangle", "[[2,3],[6,7]]")));
  const FileLabels read = read_labels(file, three_images());
  EXPECT_EQ(read.frames[1].size(), 1U);
  EXPECT_THAT(read.warnings, ElementsAre("001.json has no labels for 1 of 3 frames, in which nothing is removed: 0"));
  folder.write("002.json", labelme("002.png", ""));
  EXPECT_THAT(read_labels(file, three_images()).warnings,
              testing::Contains("LabelMe writes one file per image; give the folder of 001.json to read all 2 files"));
}

TEST(LabelMe, ReportsTheMalformedFile) {
  const TestFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error([&] { read_labels(folder.write("000.json", text), three_images()); });
  };
  EXPECT_THAT(error(labelme("000.png", shape("rectangle", "[[2,3],[6,7]]"), 40)),
              AllOf(HasSubstr("000.json"), HasSubstr("is 40x12 pixels, but the drive's images are 20x12")));
  EXPECT_THAT(error(labelme("x.png", "")), HasSubstr("no image of the drive"));
  EXPECT_THAT(error(labelme("000.png", shape("polygon", "[[1],[2,2],[3,3]]"))), HasSubstr("000.json"));
  EXPECT_THAT(error(labelme("000.png", shape("polygon", "[[1,1e9],[2,2],[3,3]]"))), HasSubstr("far outside"));
  EXPECT_THAT(error(labelme("000.png", shape("polygon", "3"))), HasSubstr("000.json"));
  EXPECT_THAT(error(labelme("000.png", R"({"label":3,"points":[]})")), HasSubstr("must be string"));
  EXPECT_THAT(error(R"({"shapes":3,"imagePath":"000.png"})"), HasSubstr("000.json"));
  EXPECT_THAT(error(R"({"shapes":[],"imagePath":"000.png")"), HasSubstr("parse error"));
}

TEST(UnreadLabels, AreRefusedWithARemedy) {
  const TestFolder folder;
  const auto expect = [&](const std::string& name, const std::string& text, const char* format, const char* remedy) {
    const fs::path file = folder.write(name, text);
    EXPECT_THAT(input_error([&] { read_labels(file, three_images()); }),
                AllOf(HasSubstr(name), HasSubstr(format), HasSubstr("which dvi does not support"), HasSubstr(remedy)));
  };
  expect("000.txt", "2 0.133333 0.300000 0.266667 0.200000\n", "YOLO labels of one image", "give the folder");
  expect("001.txt", "0 0.1 0.1 0.2 0.1 0.2 0.2\r\n", "YOLO labels of one image", "give the folder");
  expect("gt.txt", "1,1,912,484,97,109,0,7,1\n", "MOT labels", "COCO");
  expect("label.txt", "Truck 0.00 0 -1.57 600 150 630 190 2.85 2.63 12.34 0.47 1.49 69.44 -1.56\n", "KITTI object labels",
         "tracking labels");
  expect("a.xml", "<annotation><filename>000.png</filename><object><name>car</name><bndbox/></object></annotation>",
         "Pascal VOC", "COCO");
  expect("a.npy", std::string("\x93NUMPY\x01\x00v", 9), "a single NumPy array", "give the folder");
  expect("a.npz", "PK\x03\x04masks.npy", "NumPy archives", "np.save");
  expect("a.zip",
         "PK\x03\x04"
         "annotations.xml",
         "a ZIP archive", "unpack");
  expect("c.json", R"({"images":[],"annotations":[{"image_id":5,"caption":"a car"}]})", "COCO captions", "instances");
  expect("r.json", R"([{"image_id":5,"category_id":3,"bbox":[1,2,3,4],"score":0.9}])", "COCO results", "\"images\"");
  EXPECT_THAT(input_error([&] { read_labels(folder.write("x.json", R"({"version":"5"})"), three_images()); }),
              AllOf(HasSubstr("holds no labels in a supported format"), HasSubstr("COCO JSON"), HasSubstr("LabelMe")));
  EXPECT_THAT(input_error([&] { read_labels(folder.write("empty.txt", " \n"), three_images()); }), HasSubstr("is empty"));
}

}  // namespace
}  // namespace dvi::labels
