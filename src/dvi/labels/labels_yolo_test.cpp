
#include "dvi/drive/outline.h"
#include "dvi/labels/class_ids.h"
#include "dvi/labels/class_names.h"
#include "dvi/labels/label_folder.h"
#include "dvi/labels/labels.h"
#include "dvi/testing/image_drive.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Four images of 40 x 20 pixels, 000 to 003.
Drive four_images() { return make_image_drive(4, {40, 20}); }

cv::Mat1b draw_yolo(const Label& label) {
  cv::Mat1b mask(20, 40, uchar{0});
  draw(label.instance.value(), mask);
  return mask;
}

// The format is that of ultralytics' save_txt: "%g" of class, box or polygon, then confidence and track if they are asked for.
class Yolo : public testing::Test {
 protected:
  void write(const std::string& frame, const std::string& text) const { folder.write("p/labels/" + frame + ".txt", text); }
  FileLabels read() const { return read_labels(folder.path / "p", four_images()); }
  std::string error() const {
    return input_error([&] { read(); });
  }

  TestFolder folder;
};

TEST_F(Yolo, ReadsBoxes) {
  write("000", "2 0.5 0.5 0.25 0.2\n7 0.05 0.9 0.2 0.4\r\n");
  write("001", "");
  write("003", "\n2 0.5 0.5 0.1 0.1");
  EXPECT_TRUE(holds_labels(folder.path / "p", "front"));
  EXPECT_TRUE(holds_labels(folder.path / "p/labels", "front"));
  const FileLabels labels = read();
  ASSERT_EQ(labels.frames[0].size(), 2U);
  EXPECT_EQ(*labels.frames[0][0].rect, cv::Rect2d(15, 8, 10, 4));
  EXPECT_EQ(*labels.frames[0][1].rect, cv::Rect2d(0, 14, 6, 6)) << "boxes are clipped to the image";
  EXPECT_EQ(labels.frames[0][0].type, "class 2");
  EXPECT_THAT(labels.frames[1], IsEmpty());
  EXPECT_EQ(labels.frames[3].size(), 1U);
  write("003", "2 0.266667 0.45 0.133333 0.3");  // 6 digits of 4/15 and 2/15
  Drive small = four_images();
  small.camera.width = 15, small.camera.height = 10;
  EXPECT_EQ(*read_labels(folder.path / "p", small).frames[3][0].rect, cv::Rect2d(3, 3, 2, 3));
  EXPECT_THAT(labels.warnings, ElementsAre("labels: 1 of 4 frames have no label file and count as frames without objects: 2"));
  EXPECT_EQ(labels.files.size(), 3U);
}

TEST_F(Yolo, ReadsConfidencesAndTracksOfBoxes) {
  write("000", "2 0.5 0.5 0.25 0.2 0.71 4\n7 0.1 0.5 0.2 0.2 0.5");
  write("001", "2 0.5 0.5 0.25 0.2 1 4\n");
  const FileLabels both = read();
  EXPECT_EQ(both.frames[0][0].track, 4);
  EXPECT_EQ(both.frames[0][1].track, -1) << "a confidence without a track";
  EXPECT_EQ(both.frames[1][0].track, 4);
  write("000", "2 0.5 0.5 0.25 0.2 4\n7 0.1 0.5 0.2 0.2 1");
  write("001", "2 0.5 0.5 0.25 0.2 4\n");
  EXPECT_EQ(read().frames[0][1].track, 1);
  write("001", "2 0.5 0.5 0.25 0.2 1\n2 0.2 0.5 0.1 0.2 1\n");
  write("000", "");
  EXPECT_EQ(read().frames[1][1].track, -1) << "two objects of a frame have different tracks";
}

TEST_F(Yolo, ReadsPolygons) {
  const std::string square = "0.25 0.2 0.5 0.2 0.5 0.6 0.25 0.6", triangle = "0.25 0.2 0.5 0.2 0.5 0.6";
  write("000", "0 " + square + "\n0 " + triangle + "\n1 0.5 0.5 0.25 0.2");
  FileLabels labels = read();
  cv::Mat1b expected(20, 40, uchar{0});
  expected(cv::Rect(10, 4, 10, 8)) = 255;
  EXPECT_EQ(cv::countNonZero(draw_yolo(labels.frames[0][0]) != expected), 0);
  EXPECT_NEAR(cv::countNonZero(draw_yolo(labels.frames[0][1])), 40, 5);
  EXPECT_EQ(*labels.frames[0][2].rect, cv::Rect2d(15, 8, 10, 4)) << "a box beside polygons";
  write("000", "0 " + triangle + "\n");
  EXPECT_TRUE(read().frames[0][0].instance);
  for (const char* extras : {" 0.83", " 7", " 0.83 7"}) {
    write("000", "0 " + square + extras + "\n3" + extras + "\n");
    labels = read();
    ASSERT_EQ(labels.frames[0].size(), 1U) << extras;
    EXPECT_EQ(cv::countNonZero(draw_yolo(labels.frames[0][0]) != expected), 0) << extras;
    EXPECT_EQ(labels.frames[0][0].track, std::string(extras).ends_with('7') ? 7 : -1) << extras;
    EXPECT_THAT(labels.warnings, testing::Contains("labels: 1 polygons with fewer than three corners are ignored"));
  }
  write("000", "0 " + square + " 0.83 1\n");
  for (const char* frame : {"001", "002"}) write(frame, "0 " + square + " 0.9 1\n");
  EXPECT_EQ(cv::countNonZero(draw_yolo(read().frames[0][0]) != expected), 0) << "the only track is 1";
}

TEST_F(Yolo, ReadsNamesOfClasses) {
  write("000", "2 0.5 0.5 0.25 0.2\n0 0.1 0.5 0.2 0.2\n");
  const auto types = [&] {
    const FileLabels labels = read();
    EXPECT_EQ(labels.files.size(), 2U) << "the file of names is an input of a run";
    return labels.frames[0][0].type + "," + labels.frames[0][1].type;
  };
  for (const char* yaml : {"train: images\nnc: 3\nnames: ['Person', \"bus\", car]  # three\n",
                           "names: [person, bus,\n  car]\nnc: 3", "names:\n- Person\n- bus\n- 'car'\ntrain: x\n",
                           "names:\n  0: person\n  1: bus # large\n\n  2: \"Car\"\n", "names: {0: person, 1: bus, 2: car}"}) {
    folder.write("p/data.yaml", yaml);
    EXPECT_EQ(types(), "car,person") << yaml;
  }
  fs::remove(folder.path / "p/data.yaml");
  folder.write("p/labels/classes.txt", "person\nbus\ncar\n");
  EXPECT_EQ(types(), "car,person");
  folder.write("p/labels/classes.txt", "person\nbus\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("000.txt:1"), HasSubstr("class 2 has no name"), HasSubstr("classes.txt")));
  folder.write("p/dataset.yaml", "nc: 3\n");
  fs::remove(folder.path / "p/labels/classes.txt");
  EXPECT_THAT(error(), AllOf(HasSubstr("dataset.yaml"), HasSubstr("has no names of classes")));
}

TEST_F(Yolo, SelectsClassesByNameOrNumber) {
  write("000", "2 0.5 0.5 0.25 0.2\n0 0.1 0.5 0.2 0.2\n9 0.2 0.2 0.1 0.1\n");
  for (const bool named : {false, true}) {
    if (named) folder.write("p/data.yaml", "names: {0: person, 2: car, 9: traffic light}\n");
    Drive drive = four_images();
    drive.frames[0].labels = read().frames[0];
    keep_label_types(drive, named ? "car,0" : "2,0");
    EXPECT_EQ(drive.frames[0].labels.size(), 2U);
    EXPECT_THAT(drive.warnings, IsEmpty());
  }
}

TEST_F(Yolo, FindsTheFolderOfTheCamera) {
  write("front/000", "2 0.5 0.5 0.25 0.2\n");
  write("rear/001", "2 0.5 0.5 0.25 0.2\n");
  const FileLabels labels = read();
  EXPECT_EQ(labels.frames[0].size(), 1U);
  EXPECT_THAT(labels.frames[1], IsEmpty());
  EXPECT_FALSE(holds_labels(folder.path / "p", "left")) << "the labels are of other cameras";
  Drive rear = four_images();
  rear.camera_name = "rear";
  EXPECT_TRUE(attach_camera_labels(rear, folder.path / "p"));
  EXPECT_EQ(rear.frames[1].labels.size(), 1U);
  rear.camera_name = "left";
  EXPECT_FALSE(attach_camera_labels(rear, folder.path / "p"));
  EXPECT_FALSE(attach_camera_labels(rear, folder.path / "p/labels/front")) << "without a folder per camera";
}

TEST_F(Yolo, ReportsTheMalformedLine) {
  write("000", "2 0.5 0.5 0.25 0.2\n2 620 0.5 0.25 0.2\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("000.txt:2"), HasSubstr("'620' is not a fraction of the image"), HasSubstr("divided")));
  write("000", "2 0.5 0.5 0.25\n0 0.1 0.1 0.1 0.1");
  EXPECT_THAT(input_error([&] { read_labels(folder.path / "p", four_images()); }), HasSubstr("no label files"));
  write("000", "0 0.1 0.1 0.1 0.1\n2 0.5 0.5 0.25\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("000.txt:2"), HasSubstr("has 3 numbers after the class")));
  write("000", "0 0.1 0.1 0.1 0.1\ncar 0.5 0.5 0.25 0.1\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("000.txt:2"), HasSubstr("'car'")));
  write("000", "0 0.1 0.1 0.1 0.1 3.5\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("000.txt:1"), HasSubstr("'3.5' is neither a coordinate nor a confidence")));
  fs::remove(folder.path / "p/labels/000.txt");
  write("street_7", "0 0.1 0.1 0.1 0.1\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("no image of the drive"), HasSubstr("street_7.txt"), HasSubstr("000")));
}

TEST_F(Yolo, RefusesKeypoints) {
  std::string line = "0 0.5 0.5 0.25 0.2";
  for (int i = 0; i < 17; ++i) line += " 0.4 0.5 0.9";
  write("000", line + "\n" + line + "\n" + line + "\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("labels"), HasSubstr("keypoints of people"), HasSubstr("yolo segment")));
}

TEST_F(Yolo, AcceptsOnlyEmptyFiles) {
  write("000", "");
  write("001", "");
  const FileLabels labels = read();
  for (const std::vector<Label>& frame : labels.frames) EXPECT_THAT(frame, IsEmpty());
  EXPECT_EQ(labels.warnings.size(), 1U);
}

}  // namespace
}  // namespace dvi::labels
