
#include "dvi/drive/outline.h"
#include "dvi/labels/labels.h"
#include "dvi/testing/image_drive.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Drive two_panoptic_images() { return make_image_drive(2, {6, 4}); }

// The id of a segment is R + 256 G + 65536 B (panopticapi, rgb2id).
cv::Vec3b to_bgr_of(int id) {
  return {static_cast<uchar>(id >> 16), static_cast<uchar>(id >> 8 & 255), static_cast<uchar>(id & 255)};
}

constexpr const char* kPanoptic = R"({"images": [{"id": 5, "file_name": "000.jpg", "width": 6, "height": 4}],
  "annotations": [{"image_id": 5, "file_name": "000.png", "segments_info": [
    {"id": 131587, "category_id": 3, "iscrowd": 0}, {"id": 300, "category_id": 100, "iscrowd": 0},
    {"id": 4, "category_id": 8, "iscrowd": 1}]}],
  "categories": [{"id": 3, "name": "Car", "isthing": 1}, {"id": 100, "name": "road", "isthing": @STUFF@}]})";

class PanopticFile : public testing::Test {
 protected:
  PanopticFile() {
    cv::Mat3b colors(4, 6, to_bgr_of(300));
    colors(cv::Rect(1, 1, 3, 2)) = to_bgr_of(131587);
    colors(3, 5) = to_bgr_of(4);
    folder.write_image("a/panoptic_val/000.png", colors);
    write("0");
  }
  void write(const std::string& stuff) const {
    std::string text = kPanoptic;
    folder.write("a/panoptic_val.json", text.replace(text.find("@STUFF@"), 7, stuff));
  }
  FileLabels read() const { return read_labels(folder.path / "a/panoptic_val.json", two_panoptic_images()); }

  TestFolder folder;
};

TEST_F(PanopticFile, ReadsThings) {
  const FileLabels labels = read();
  ASSERT_EQ(labels.frames[0].size(), 2U);
  EXPECT_EQ(labels.frames[0][0].type, "car");
  EXPECT_EQ(labels.frames[0][0].class_number, 3);
  EXPECT_EQ(labels.frames[0][1].type, "class 8") << "a category without a name";
  cv::Mat1b expected(4, 6, uchar{0}), drawn(4, 6, uchar{0});
  expected(cv::Rect(1, 1, 3, 2)) = 255;
  draw(labels.frames[0][0].instance.value(), drawn);
  EXPECT_EQ(cv::countNonZero(expected != drawn), 0);
  EXPECT_EQ(labels.files.size(), 2U) << "the PNG file is an input of a run";
  write("1");
  EXPECT_EQ(read().frames[0].size(), 3U);
}

TEST_F(PanopticFile, ReportsFilesThatDoNotMatch) {
  folder.write_image("a/panoptic_val/000.png", cv::Mat3b(4, 6, to_bgr_of(300)));
  EXPECT_THAT(input_error([&] { read(); }), AllOf(HasSubstr("000.png"), HasSubstr("has no pixel of segment 131587")));
  folder.write_image("a/panoptic_val/000.png", cv::Mat3b(8, 6, to_bgr_of(300)));
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("6x8 pixels instead of 6x4"));
  fs::remove(folder.path / "a/panoptic_val/000.png");
  EXPECT_THAT(input_error([&] { read(); }),
              AllOf(HasSubstr("panoptic_val.json"), HasSubstr("its image 000.png is missing"), HasSubstr("put the PNG files")));
  folder.write("a/panoptic_val.json", R"({"annotations": [{"image_id": 5, "segments_info": []}]})");
  EXPECT_THAT(input_error([&] { read(); }), HasSubstr("file_name"));
}

}  // namespace
}  // namespace dvi::labels
