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

const cv::Size kPicture(20, 12);

Drive drive_of(int frames) { return make_image_drive(frames, kPicture, 100); }

cv::Mat1b mask_of_outline(const Label& label) {
  cv::Mat1b mask(kPicture, uchar{0});
  draw(label.instance.value(), mask);
  return mask;
}

void expect_filled(const Label& label, const cv::Rect& part) {
  cv::Mat1b mask(kPicture, uchar{0});
  mask(part) = 255;
  EXPECT_EQ(cv::norm(mask_of_outline(label), mask, cv::NORM_INF), 0) << part;
}

std::string cvat(const std::string& inside, const std::string& task = "<size>10</size>") {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<annotations><version>1.1</version><meta><task>" + task +
         "</task></meta>\n" + inside + "</annotations>\n";
}

std::string box(int frame, double x, double y, const std::string& more = "") {
  return fmt::format(R"(<box frame="{}" keyframe="1" xtl="{}" ytl="{}" xbr="{}" ybr="{}" {}/>)", frame, x, y, x + 4, y + 2,
                     more);
}

std::string track(const std::string& shapes) { return R"(<track id="3" label="Car">)" + shapes + "</track>"; }

TEST(Cvat, InterpolatesBoxesBetweenKeyframes) {
  const TestFolder folder;
  const auto file = folder.write(
      "a.xml", cvat(track(box(6, 8, 4) + box(2, 0, 2, "outside=\"0\" occluded=\"1\"") + box(8, 9, 5, "outside=\"1\""))));
  const FileLabels read = read_labels(file, drive_of(12));
  std::vector<int> labeled;
  for (int i = 0; i < 12; ++i)
    if (!read.frames[static_cast<std::size_t>(i)].empty()) labeled.push_back(i);
  EXPECT_THAT(labeled, ElementsAre(2, 3, 4, 5, 6, 7)) << "from the first shape to the frame before it is outside";
  const Label& car = read.frames[3].at(0);
  EXPECT_EQ(car.type, "car");
  EXPECT_EQ(car.track, 3);
  EXPECT_EQ(*car.rect, cv::Rect2d(2, 2.5, 4, 2));
  EXPECT_EQ(*read.frames[6][0].rect, cv::Rect2d(8, 4, 4, 2));
  EXPECT_EQ(*read.frames[7][0].rect, cv::Rect2d(8.5, 4.5, 4, 2));
  EXPECT_THAT(read.frames_after_last.frames, ElementsAre(110, 111)) << "the task has 10 frames";
}

TEST(Cvat, KeepsATrackToTheEndOfTheTask) {
  const TestFolder folder;
  const auto last = [&](const std::string& task) {
    const FileLabels read = read_labels(folder.write("a.xml", cvat(track(box(2, 0, 2)), task)), drive_of(6));
    std::size_t end = 0;
    for (std::size_t i = 0; i < 6; ++i)
      if (!read.frames[i].empty()) end = i;
    return end;
  };
  EXPECT_EQ(last("<size>5</size>"), 4U);
  EXPECT_EQ(last("<size>5</size><start_frame>0</start_frame><stop_frame>3</stop_frame>"), 3U);
  EXPECT_EQ(last(""), 5U);
  EXPECT_EQ(last("<size>0</size>"), 5U);
}

TEST(Cvat, NumbersTheFramesOfTheWholeRecording) {
  const TestFolder folder;
  Drive drive = drive_of(3);
  for (int i = 0; i < 5; ++i) folder.write(fmt::format("images/{:03}.png", i), "an image");
  for (Frame& frame : drive.frames) frame.file = folder.path / "images" / (frame.name + ".png");
  drive.frames.erase(drive.frames.begin(), drive.frames.begin() + 2);  // as --frames 102
  const FileLabels read = read_labels(folder.write("a.xml", cvat(track(box(0, 0, 2) + box(4, 8, 2)))), drive);
  EXPECT_EQ(*read.frames.at(0).at(0).rect, cv::Rect2d(4, 2, 4, 2));
  EXPECT_TRUE(read.warnings.empty());
}

TEST(Cvat, InterpolatesPolygonsByCorner) {
  const TestFolder folder;
  const auto polygon = [](int frame, const char* points) {
    return fmt::format(R"(<polygon frame="{}" outside="0" points="{}"/>)", frame, points);
  };
  const auto file = folder.write("a.xml", cvat(track(polygon(0, "0,0;4,0;4,4;0,4") + polygon(2, "4,2;12,2;12,6;4,6") +
                                                     polygon(6, "10,10;14,10;14,12;12,12;10,12"))));
  const FrameLabels labels = read_labels(file, drive_of(7)).frames;
  expect_filled(labels[0].at(0), {0, 0, 4, 4});
  expect_filled(labels[1].at(0), {2, 1, 6, 4});
  expect_filled(labels[3].at(0), {4, 2, 8, 4});  // the next shape has another number of corners
  expect_filled(labels[4].at(0), {10, 10, 4, 2});
}

TEST(Cvat, RotatesBoxes) {
  const TestFolder folder;
  const auto file = folder.write("a.xml", cvat(track(box(0, 4, 5, R"(rotation="90")"))));
  expect_filled(read_labels(file, drive_of(1)).frames[0].at(0), {5, 4, 2, 4});
}

TEST(Cvat, ReadsImages) {
  const TestFolder folder;
  const auto file = folder.write("a.xml", cvat(R"(
    <image id="0" name="sub/001.jpg" width="20" height="12">
      <box label="Van" xtl="-3.5" ytl="1" xbr="4" ybr="30" z_order="0"><attribute name="id">4</attribute></box>
      <polygon label="car" points="6.00,2.00;9.00,2.00;9.00,5.00;6.00,5.00"/>
      <mask label="person" rle="1, 2, 1, 1, 1" left="10" top="3" width="2" height="3"/>
      <polyline label="lane" points="1,1;2,2"/><box label="far" xtl="30" ytl="1" xbr="34" ybr="3"/>
    </image><image id="1" name="002.jpg" width="20" height="12"/>)"));
  const FileLabels read = read_labels(file, drive_of(4));
  ASSERT_EQ(read.frames[1].size(), 3U);
  EXPECT_EQ(*read.frames[1][0].rect, cv::Rect2d(0, 1, 4, 11));
  EXPECT_EQ(read.frames[1][0].type, "van");
  EXPECT_EQ(read.frames[1][0].track, -1);
  expect_filled(read.frames[1][1], {6, 2, 3, 3});
  cv::Mat1b person(kPicture, uchar{0});
  person(3, 11) = person(4, 10) = person(5, 10) = 255;
  EXPECT_EQ(cv::norm(mask_of_outline(read.frames[1][2]), person, cv::NORM_INF), 0);
  EXPECT_THAT(read.warnings,
              ElementsAre(HasSubstr("1 <polyline> ignored"), HasSubstr("1 object outside the image, the first in frame 001"),
                          "a.xml has no labels for 1 of 4 frames, in which nothing is removed: 100"));
  EXPECT_THAT(read.frames_after_last.frames, ElementsAre(103));
}

TEST(Cvat, WarnsOfFramesThatTheDriveDoesNotHave) {
  const TestFolder folder;
  const auto file = folder.write("a.xml", cvat(track(box(2, 0, 2) + box(2000000000, 8, 2))));
  EXPECT_THAT(read_labels(file, drive_of(4)).warnings,
              ElementsAre(AllOf(HasSubstr("1 shapes in frames that the drive does not have"), HasSubstr("2000000000"),
                                HasSubstr("4 images, from 0"))));
}

TEST(Cvat, MapsATaskOfAPartOfAVideoToItsImages) {
  const TestFolder folder;
  // Frames 10, 13, 16, 19 of a video with their numbers there, as CVAT exports a task with a frame filter.
  const std::string task =
      "<size>4</size><start_frame>10</start_frame><stop_frame>19</stop_frame>"
      "<frame_filter>step=3</frame_filter>";
  const auto file = folder.write("a.xml", cvat(track(box(10, 0, 2) + box(16, 8, 4) + box(19, 8, 4, "outside=\"1\"")), task));
  const FileLabels read = read_labels(file, drive_of(4));
  EXPECT_EQ(*read.frames[0].at(0).rect, cv::Rect2d(0, 2, 4, 2));
  EXPECT_EQ(*read.frames[1].at(0).rect, cv::Rect2d(4, 3, 4, 2));
  EXPECT_EQ(*read.frames[2].at(0).rect, cv::Rect2d(8, 4, 4, 2));
  EXPECT_TRUE(read.frames[3].empty());
  EXPECT_THAT(read.warnings,
              ElementsAre(HasSubstr("one in 3 of the frames 10 to 19 of a video: these are mapped to the drive's 4 images")));
  const FileLabels whole = read_labels(file, drive_of(20));
  EXPECT_EQ(*whole.frames[13].at(0).rect, cv::Rect2d(4, 3, 4, 2)) << "the drive has the whole video";
  EXPECT_THAT(whole.warnings, testing::Contains(HasSubstr("only one in 3 frames of a video")));
  const auto counted = folder.write("b.xml", cvat(track(box(10, 0, 2) + box(11, 8, 4)), task));
  EXPECT_THAT(input_error([&] { read_labels(counted, drive_of(20)); }), HasSubstr("frame 11 is not in the task"));
}

TEST(Cvat, RefusesLabelsWithoutAFrameOfTheDrive) {
  const TestFolder folder;
  const auto file = folder.write("a.xml", cvat(track(box(100, 0, 2) + box(119, 8, 2))));
  EXPECT_THAT(input_error([&] { read_labels(file, drive_of(20)); }),
              HasSubstr("its shapes are in frames 100 to 119, but the drive's images are 0 to 19"));
}

TEST(Cvat, ReportsThePositionOfErrors) {
  const TestFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error([&] { read_labels(folder.write("a.xml", text), drive_of(4)); });
  };
  const auto expect = [&](const std::string& inside, const char* what) {
    EXPECT_THAT(error(cvat(inside)), AllOf(HasSubstr("a.xml"), HasSubstr("at byte "), HasSubstr(what))) << inside;
  };
  expect(track(R"(<box frame="0" xtl="a" ytl="1" xbr="2" ybr="3"/>)"), "'a' is not a position in an image");
  expect(track(R"(<box frame="0" xtl="1e9" ytl="1" xbr="2e9" ybr="3"/>)"), "'1e9' is not a position in an image");
  expect(track(R"(<box frame="0" xtl="4" ytl="1" xbr="2" ybr="3"/>)"), "left of or above");
  expect(track(R"(<box frame="0" xtl="1" ytl="1" xbr="2"/>)"), "<box> at byte");
  expect(track(R"(<box frame="-1" xtl="1" ytl="1" xbr="2" ybr="3"/>)"), "frame=\"-1\" is not a whole number");
  expect(track(box(0, 1, 1, "outside=\"yes\"")), "neither 0 nor 1");
  expect(track(box(0, 1, 1, "rotation=\"left\"")), "rotation=\"left\" is not a number");
  expect(track(box(1, 1, 1) + box(1, 2, 2)), "track 3 has two shapes in frame 1");
  expect(track(R"(<polygon frame="0" points="1,1;2,2"/>)"), "fewer than three");
  expect(track(R"(<polygon frame="0" points="1,1;2;3,3"/>)"), "x,y;x,y");
  expect(R"(<track id="x" label="car"/>)", "id=\"x\"");
  expect(R"(<track id="1"/>)", "has no attribute label");
  const auto image = [](const std::string& shape) {
    return R"(<image name="001.png" width="20" height="12">)" + shape + "</image>";
  };
  expect(image(R"(<mask label="a" rle="1,2" left="0" top="0" width="2" height="2"/>)"), "fill width x height");
  expect(image(R"(<mask label="a" rle="1,5" left="0" top="0" width="2" height="2"/>)"), "fill width x height");
  expect(image(R"(<mask label="a" rle="1;3" left="0" top="0" width="2" height="2"/>)"), "fill width x height");
  expect(image(R"(<mask label="a" rle="4" left="19" top="0" width="2" height="2"/>)"), "beyond the image");
  EXPECT_THAT(error(cvat(R"(<image name="001.png" width="21" height="12"/>)")), HasSubstr("001.png is 21x12 pixels"));
  EXPECT_THAT(error(cvat(R"(<image name="9.png" width="20" height="12"/>)")), HasSubstr("no image of the drive"));
  EXPECT_THAT(error(cvat("", "<original_size><width>1</width><height>2</height></original_size>")),
              HasSubstr("the task is 1x2 pixels"));
  EXPECT_THAT(error("<annotations><track"), HasSubstr("malformed XML"));
  EXPECT_THAT(error("<other><annotations/></other>"), HasSubstr("has no <annotations>"));
}

}  // namespace
}  // namespace dvi::labels
