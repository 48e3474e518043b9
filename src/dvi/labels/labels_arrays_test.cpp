#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"
#include "dvi/drive/outline.h"
#include "dvi/labels/labels.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/labels/mask_reading.h"
#include "dvi/media/video.h"
#include "dvi/testing/image_drive.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Three images of 6 x 4 pixels, 000 to 002.
Drive three_small_images(cv::Size size = {6, 4}) { return make_image_drive(3, size); }

// Writes an array as numpy.save does.
std::string save_array(const cv::Mat& mask, const std::string& type) {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}, {}), }}", type, mask.rows, mask.cols);
  header.resize(117, ' ');
  return std::string("\x93NUMPY\x01\x00v\x00", 10) + header + '\n' +
         std::string(reinterpret_cast<const char*>(mask.data), mask.total() * mask.elemSize());
}

// An object 1 of 2 x 2 pixels and an object 7 of one pixel.
cv::Mat1w two_objects() {
  cv::Mat1w ids(4, 6, ushort{0});
  ids(cv::Rect(1, 1, 2, 2)) = 1;
  ids(3, 5) = 7;
  return ids;
}

cv::Mat1b draw_outline(const Label& label, cv::Size size = {6, 4}) {
  cv::Mat1b mask(size, uchar{0});
  draw(label.instance.value(), mask);
  return mask;
}

constexpr const char* kObjects = R"({"mask_name": "mask_000.npy", "mask_height": 4, "mask_width": 6, "promote_type": "mask",
  "labels": {"1": {"instance_id": 1, "class_name": "Car", "x1": 1, "y1": 1, "x2": 2, "y2": 2, "logit": 0.0},
             "7": {"instance_id": 7, "class_name": "person", "x1": 5, "y1": 3, "x2": 5, "y2": 3, "logit": 0.0}}})";

TEST(GroundedSam, ReadsArraysWithNames) {
  const TestFolder folder;
  folder.write("out/mask_data/mask_000.npy", save_array(two_objects(), "<u2"));
  folder.write("out/mask_data/mask_001.npy", save_array(cv::Mat1w(4, 6, ushort{0}), "<u2"));
  folder.write("out/json_data/mask_000.json", kObjects);
  folder.write("out/json_data/mask_001.json", "{}");
  for (const char* given : {"out", "out/mask_data"}) {
    EXPECT_TRUE(holds_labels(folder.path / given, "front"));
    const FileLabels read = read_labels(folder.path / given, three_small_images());
    ASSERT_EQ(read.frames[0].size(), 2U);
    EXPECT_EQ(read.frames[0][0].type, "car");
    EXPECT_EQ(read.frames[0][0].track, 1);
    EXPECT_EQ(cv::countNonZero(draw_outline(read.frames[0][0]) != (two_objects() == 1)), 0);
    EXPECT_EQ(cv::countNonZero(draw_outline(read.frames[0][1]) != (two_objects() == 7)), 0);
    EXPECT_THAT(read.frames[1], IsEmpty());
    EXPECT_THAT(read.frames_after_last.frames, ElementsAre(2)) << "this image has no array";
    EXPECT_EQ(read.files.size(), 4U);
  }
}

TEST(GroundedSam, ReportsFilesThatDoNotMatch) {
  const TestFolder folder;
  const auto error = [&] { return input_error([&] { read_labels(folder.path / "out", three_small_images()); }); };
  folder.write("out/mask_000.npy", save_array(two_objects(), "<u2"));
  folder.write("out/mask_000.json", R"({"labels": {"1": {"class_name": "car"}}})");
  EXPECT_THAT(error(), AllOf(HasSubstr("mask_000.npy"), HasSubstr("has an object 7"), HasSubstr("mask_000.json")));
  folder.write("out/mask_000.json", R"({"labels": {"car": {}}})");
  EXPECT_THAT(error(), AllOf(HasSubstr("mask_000.json"), HasSubstr("'car'")));
  folder.write("out/mask_000.json", "{");
  EXPECT_THAT(error(), HasSubstr("parse error"));
  folder.write("out/mask_000.json", kObjects);
  folder.write("out/mask_001.npy", save_array(two_objects(), "<u2"));
  EXPECT_THAT(error(), AllOf(HasSubstr("mask_001.npy"), HasSubstr("has no JSON file")));
  folder.write("out/mask_001.npy", save_array(cv::Mat1w(6, 4, ushort{0}), "<u2"));
  folder.write("out/mask_001.json", "{}");
  EXPECT_THAT(error(), AllOf(HasSubstr("mask_001.npy"), HasSubstr("is 4x6 pixels instead of 6x4")));
}

TEST(MaskArrays, AreReadLikeImages) {
  const TestFolder folder;
  for (int i = 0; i < 3; ++i) folder.write(fmt::format("m/{:03}.npy", i), save_array(two_objects(), "<u2"));
  EXPECT_FALSE(holds_labels(folder.path / "m", "front"));
  Drive drive = three_small_images();
  attach_masks(drive, folder.path / "m");
  read_masks(drive, {});
  EXPECT_EQ(cv::countNonZero(*drive.masks[2] != (two_objects() != 0)), 0);
  read_masks(drive, {.classes = "7"});
  EXPECT_EQ(cv::countNonZero(*drive.masks[2] != (two_objects() == 7)), 0);
  folder.write("m/001.npy", save_array(two_objects(), "|O"));
  EXPECT_THAT(input_error([&] { read_masks(drive, {}); }), AllOf(HasSubstr("001.npy"), HasSubstr("type '|O'")));
}

// OpenDroneMap and Metashape write NAME_mask.png, in which black is ignored.
TEST(MaskFiles, OfOpenDroneMapAreBlackWhereObjectsAre) {
  const TestFolder folder;
  cv::Mat1b mask(4, 6, uchar{255});
  mask(cv::Rect(1, 1, 2, 2)) = 0;
  for (int i = 0; i < 3; ++i) folder.write_image(fmt::format("m/{:03}_mask.png", i), mask);
  Drive drive = three_small_images();
  attach_masks(drive, folder.path / "m");
  for (const Polarity polarity : {Polarity::automatic, Polarity::black}) {
    read_masks(drive, {.polarity = polarity});
    EXPECT_EQ(cv::countNonZero(*drive.masks[1] == mask), 0) << "the inverse";
  }
  EXPECT_THAT(drive.warnings, Contains(HasSubstr("black means remove")));
}

// White where x < 10 + 5 * i, in frame i of a video of 64 x 48 pixels.
cv::Mat1b video_mask(int i) {
  cv::Mat1b mask(48, 64, uchar{0});
  mask(cv::Rect(0, 0, 10 + 5 * i, 48)) = 255;
  return mask;
}

void write_video(const fs::path& file, int frames, bool inverted, cv::Size size = {64, 48}) {
  media::VideoWriter video({file, size});
  media::SegmentEncoder segment({file, size});
  for (int i = 0; i < frames; ++i) {
    cv::Mat3b colors;
    cv::cvtColor(inverted ? cv::Mat1b(~video_mask(i)) : video_mask(i), colors, cv::COLOR_GRAY2BGR);
    cv::resize(colors, colors, size);
    segment.push(colors);
  }
  video.append(segment.finish());
  video.finish();
}

double overlap(const cv::Mat1b& a, const cv::Mat1b& b) {
  return cv::countNonZero(a & b) / static_cast<double>(cv::countNonZero(a | b));
}

TEST(MaskVideo, HasTheMasksOfTheFrames) {
  const TestFolder folder;
  for (const bool inverted : {false, true}) {
    const fs::path file = folder.path / "masks.mp4";
    write_video(file, 3, inverted);
    EXPECT_FALSE(holds_labels(file, "front"));
    Drive drive = three_small_images({64, 48});
    attach_masks(drive, file);
    read_masks(drive, {});
    for (std::size_t i = 0; i < 3; ++i) EXPECT_GE(overlap(*drive.masks[i], video_mask(static_cast<int>(i))), 0.99);
    EXPECT_THAT(drive.other_files, Contains(file));
    EXPECT_EQ(drive.warnings.size(), inverted ? 1U : 0U);
    read_masks(drive, {.polarity = Polarity::white});
    EXPECT_GE(overlap(*drive.masks[1], inverted ? cv::Mat1b(~video_mask(1)) : video_mask(1)), 0.99);
    EXPECT_THROW(read_masks(drive, {.classes = "car"}), UsageError);
  }
}

TEST(MaskVideo, OfTheWholeRecordingFitsAnExcerpt) {
  const TestFolder folder;
  Drive drive = three_small_images({64, 48});
  for (Frame& frame : drive.frames) {
    frame.file = folder.path / "images" / (frame.name + ".png");
    folder.write("images/" + frame.name + ".png", "");
  }
  drive.frames.erase(drive.frames.begin());
  write_video(folder.path / "masks.mp4", 3, false);
  attach_masks(drive, folder.path / "masks.mp4");
  EXPECT_GE(overlap(*drive.masks[0], video_mask(1)), 0.99);
  write_video(folder.path / "masks.mp4", 2, false);
  attach_masks(drive, folder.path / "masks.mp4");
  EXPECT_GE(overlap(*drive.masks[0], video_mask(0)), 0.99);
  write_video(folder.path / "masks.mp4", 5, false);
  EXPECT_THAT(input_error([&] { attach_masks(drive, folder.path / "masks.mp4"); }),
              AllOf(HasSubstr("has 5 frames, but the drive has 3 images, 2 of them selected"), HasSubstr("n-th image")));
}

TEST(MaskVideo, HasTheSizeOfTheImages) {
  const TestFolder folder;
  const fs::path file = folder.path / "masks.mp4";
  write_video(file, 3, false, {32, 24});
  Drive drive = three_small_images({64, 48});
  EXPECT_THAT(input_error([&] { attach_masks(drive, file); }), HasSubstr("is 32x24 pixels instead of 64x48"));
  write_video(file, 3, false);
  drive = three_small_images({63, 47});
  attach_masks(drive, file);  // encoders require even sizes
  EXPECT_EQ(drive.masks[0]->size(), cv::Size(63, 47));
  folder.write("masks.mp4", "no video");
  EXPECT_THAT(input_error([&] { attach_masks(drive, file); }), HasSubstr("is not a video"));
}

}  // namespace
}  // namespace dvi::labels
