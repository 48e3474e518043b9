#include "dvi/labels/labels.h"

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include "dvi/labels/class_ids.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kTolerance = 1e-9;

// Two frames of a camera at the LiDAR's position that looks along the LiDAR's x.
Drive two_frames() {
  Drive drive;
  drive.camera.width = 4, drive.camera.height = 3;
  drive.camera_from_lidar.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  drive.frames = {{5, "five", 1, {}, {}}, {6, "six", 2, {}, {}}};
  return drive;
}

TEST(Labels, ReadsTracklets) {
  const TestFolder folder;
  const auto file = folder.write("tracklet_labels.xml", R"(<?xml version="1.0" encoding="UTF-8" standalone="yes" ?>
<!DOCTYPE boost_serialization>
<boost_serialization signature="serialization::archive" version="9">
<tracklets class_id="0" tracking_level="0" version="0">
	<count>2</count><item_version>1</item_version>
	<item class_id="1" tracking_level="0" version="1">
		<objectType>Van</objectType><h>2</h><w>1.8</w><l>4.5</l><first_frame>5</first_frame>
		<poses class_id="2" tracking_level="0" version="0"><count>2</count><item_version>2</item_version>
			<item class_id="3" tracking_level="0" version="2"><tx>10</tx><ty>3</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>0.5</rz></item>
			<item><tx>11</tx><ty>3</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>0.6</rz></item>
		</poses><finished>1</finished>
	</item>
	<item><objectType>Pedestrian</objectType><h>1.8</h><w>0.6</w><l>0.6</l><first_frame>6</first_frame>
		<poses><count>1</count><item><tx>7</tx><ty>-2</ty><tz>-1.6</tz><rx>0</rx><ry>0</ry><rz>0</rz></item></poses></item>
</tracklets>
</boost_serialization>)");
  const FrameLabels labels = read_labels(file, two_frames()).frames;
  ASSERT_EQ(labels[0].size(), 1U);
  ASSERT_EQ(labels[1].size(), 2U);
  const Label& van = labels[0][0];
  EXPECT_EQ(van.type, "van");
  EXPECT_EQ(van.track, 0);
  EXPECT_TRUE(van.box->frame_from_box.t.isApprox(Eigen::Vector3d(10, 3, -0.7)));
  EXPECT_EQ(van.box->size, Eigen::Vector3d(4.5, 1.8, 2));
  EXPECT_NEAR(so3_log(van.box->frame_from_box.R).z(), 0.5, kTolerance);
  EXPECT_EQ(labels[1][1].track, 1);
}

TEST(Labels, ReadsTrackingIntoLidarAxes) {
  const TestFolder folder;
  // The object is 10 m ahead and 2 m to the left, on ground 1.7 m below the camera; a yaw of -pi/2 points ahead.
  const auto file = folder.write("0000.txt",
                                 "5 -1 DontCare -1 -1 -10 1 1 2 2 -1000 -1000 -1000 -10 -1 -1 -1\n"
                                 "5 3 Car 0 0 -1.5 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 -1.5707963267948966\n"
                                 "6 3 Car 0 0 -1.5 1 0 3 2 -1 -1 -1 -1000 -1000 -1000 -10\n");
  const FrameLabels labels = read_labels(file, two_frames()).frames;
  ASSERT_EQ(labels[0].size(), 1U);
  const Label& car = labels[0][0];
  EXPECT_EQ(car.track, 3);
  EXPECT_EQ(*car.rect, cv::Rect2d(1, 0, 2, 2));
  EXPECT_TRUE(car.box->frame_from_box.t.isApprox(Eigen::Vector3d(10, 2, -0.95)));
  EXPECT_TRUE(car.box->frame_from_box.R.isApprox(Eigen::Matrix3d::Identity(), kTolerance));
  EXPECT_EQ(car.box->size, Eigen::Vector3d(4, 1.6, 1.5));
  EXPECT_FALSE(labels[1].at(0).box);
}

TEST(Labels, ReadsOutlinesAndAddsThemToTracks) {
  const TestFolder folder;
  // Runs 4 2 1 3 2 of a 3x4 image; the characters are those of COCO's own encoder.
  const auto outlines = folder.write("instances.txt", "5 1003 1 3 4 42111\n5 10000 10 3 4 42111\n6 2001 2 3 4 <\n");
  const auto tracking = folder.write("tracking.txt", "5 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\n");
  Drive drive = two_frames();
  add_labels(drive, tracking);
  add_labels(drive, outlines);
  ASSERT_EQ(drive.frames[0].labels.size(), 1U);
  const Label& car = drive.frames[0].labels[0];
  EXPECT_TRUE(car.box && car.rect && car.instance);
  EXPECT_THAT(car.instance->runs, ElementsAre(4, 2, 1, 3, 2));
  ASSERT_EQ(drive.frames[1].labels.size(), 1U);
  EXPECT_EQ(drive.frames[1].labels[0].type, "pedestrian");
  EXPECT_EQ(drive.frames[1].labels[0].track, 1);
  EXPECT_TRUE(drive.has_labels());
  EXPECT_EQ(drive.other_files.size(), 2U);
}

TEST(Labels, ReadsBoxesByName) {
  const TestFolder folder;
  const auto file = folder.write("boxes.json", R"({"version":1,"frames":{"six":[{"track":4,"class":"Car","center":[1,2,3],
    "size":[4,5,6],"yaw":0.25}],"seven":[]}})");
  const FrameLabels labels = read_labels(file, two_frames()).frames;
  EXPECT_TRUE(labels[0].empty());
  ASSERT_EQ(labels[1].size(), 1U);
  EXPECT_EQ(labels[1][0].type, "car");
  EXPECT_EQ(labels[1][0].box->frame_from_box.t, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(so3_log(labels[1][0].box->frame_from_box.R).z(), 0.25, kTolerance);
}

TEST(Labels, WarnOfFramesThatTheDriveDoesNotHave) {
  const TestFolder folder;
  const auto box = R"([{"class":"car","center":[1,2,3],"size":[4,5,6],"yaw":0}])";
  const auto boxes =
      folder.write("boxes.json", fmt::format(R"({{"version":1,"frames":{{"five":{},"ten":{},"two":{}}}}})", box, box, box));
  const FileLabels read = read_labels(boxes, two_frames());
  EXPECT_THAT(read.warnings,
              ElementsAre("boxes.json labels 2 frames that the drive does not have, first ten: its frames are ten "
                          "to two, those of the drive are five to six"));
  EXPECT_FALSE(read.has_only_unknown_frames);
  EXPECT_EQ(read.frames_after_last.what, "boxes.json ends early: it has no labels for frames");
  EXPECT_THAT(read.frames_after_last.frames, ElementsAre(6));
  const auto all = folder.write("all.json", fmt::format(R"({{"version":1,"frames":{{"five":{},"six":[]}}}})", box));
  EXPECT_TRUE(read_labels(all, two_frames()).frames_after_last.frames.empty()) << "an empty list means that there is no object";
  const auto tracking = folder.write("tracking.txt",
                                     "6 -1 DontCare -1 -1 -10 1 1 2 2 -1000 -1000 -1000 -10 -1 -1 -1\n"
                                     "9 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\n");
  Drive drive = two_frames();
  EXPECT_TRUE(add_labels(drive, tracking).frames.empty());
  EXPECT_THAT(drive.warnings, ElementsAre("tracking.txt labels 1 frames that the drive does not have, first 9: its frames are "
                                          "9, those of the drive are 5 to 6"));
}

TEST(Labels, AreRefusedInUnknownFormats) {
  const TestFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error([&] { read_labels(folder.write("labels", text), two_frames()); });
  };
  for (const char* text : {"hello world\n", "<html></html>", "1 2 3\n"})
    EXPECT_THAT(error(text), HasSubstr("no labels in a supported format"));
  EXPECT_THAT(error("<tracklets><boost"), HasSubstr("malformed XML"));
  EXPECT_THAT(error("{\"version\":2,\"frames\":{}}"), HasSubstr("version is 2"));
  EXPECT_THAT(error("{\"version\":1e30,\"frames\":{}}"), HasSubstr("version is not a whole number"));
  EXPECT_THAT(error("{\"version\":1,\"frames\":{\"six\":[{\"class\":\"car\"}]}}"), HasSubstr("frame six:"));
  EXPECT_THAT(error("5 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\n5 3 Car 0 0 x 1 0 3 y\n"), HasSubstr("labels:2"));
  EXPECT_THAT(error("5 1003 1 30 40 abc\n"), HasSubstr("40x30 pixels, but the drive's images are 4x3"));
  EXPECT_THAT(error("5 1003 1 3 4 42\n"), HasSubstr("does not fill the image"));
  EXPECT_THAT(error("5 1003 1 3 4 4Z\n"), HasSubstr("outline is truncated"));
  // A first run of 2^32 + 4, of which 32 bits would keep 4.
  EXPECT_THAT(error("5 1003 1 3 4 TPPPPP42111\n"), HasSubstr("outline is malformed"));
}

TEST(Labels, MayHaveAByteOrderMarkAndWindowsLineEnds) {
  const TestFolder folder;
  const std::string mark = "\xEF\xBB\xBF", car = "5 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\r\n";
  EXPECT_EQ(read_labels(folder.write("tracking.txt", mark + car), two_frames()).frames[0].size(), 1U);
  EXPECT_EQ(read_labels(folder.write("mots.txt", mark + "5 1003 1 3 4 42111\r\n"), two_frames()).frames[0].size(), 1U);
  const std::string box = R"({"version":1,"frames":{"five":[{"class":"car","rect":[1,1,2,2]}],"six":[]}})";
  EXPECT_EQ(read_labels(folder.write("boxes.json", mark + box), two_frames()).frames[0].size(), 1U);
  const std::string wide("\xFF\xFE{\0}\0", 6);
  EXPECT_THAT(input_error([&] { read_labels(folder.write("wide.json", wide), two_frames()); }), HasSubstr("is UTF-16 text"));
}

TEST(Labels, OfOtherFramesOnlyAreReportedWithBothRanges) {
  const TestFolder folder;
  const auto tracking = folder.write("tracking.txt",
                                     "100 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\n"
                                     "119 3 Car 0 0 0 1 0 3 2 1.5 1.6 4.0 -2 1.7 10 0\n");
  const FileLabels read = read_labels(tracking, two_frames());
  EXPECT_TRUE(read.has_only_unknown_frames);
  EXPECT_THAT(read.warnings,
              ElementsAre("tracking.txt labels 2 frames that the drive does not have, first 100: its frames are 100 "
                          "to 119, those of the drive are 5 to 6"));
}

TEST(Labels, OfClassesThatAreNotKnownAsTrafficCauseAWarning) {
  Drive drive = two_frames();
  const auto label = [](const char* type) { return Label{.track = -1, .type = type, .box = {}, .rect = {}, .instance = {}}; };
  for (const char* type : {"other_vehicle", "human.pedestrian.adult", "Car-parked"})
    drive.frames[0].labels.push_back(label(type));
  warn_of_unknown_types(drive);
  EXPECT_TRUE(drive.warnings.empty());
  for (const char* type : {"road", "class 3", "road"}) drive.frames[1].labels.push_back(label(type));
  warn_of_unknown_types(drive);
  ASSERT_EQ(drive.warnings.size(), 1U);
  EXPECT_THAT(drive.warnings[0], AllOf(HasSubstr("(1 class 3, 2 road)"),
                                       HasSubstr("--classes \"Car-parked,human.pedestrian.adult,other_vehicle\"")));
  keep_label_types(drive, "3,other vehicle");
  EXPECT_EQ(drive.frames[0].labels.size(), 1U);
  EXPECT_EQ(drive.frames[1].labels.size(), 1U) << "a number selects a class without a name";
}

TEST(MaskFolder, ReportsTheContentOfAFolderWithoutMasks) {
  const TestFolder folder;
  Drive drive = two_frames();
  folder.write("jpeg/five.jpg", "an image");
  EXPECT_THAT(input_error([&] { attach_masks(drive, folder.path / "jpeg"); }),
              AllOf(HasSubstr("1 JPEG files"), HasSubstr("write masks as PNG")));
  folder.write("mot/five.txt", "1,1,912,484,97,109,0,7,1\n");
  EXPECT_THAT(input_error([&] { attach_masks(drive, folder.path / "mot"); }),
              AllOf(HasSubstr("holds MOT labels"), HasSubstr("the first is five.txt")));
}

TEST(MaskFolder, MatchesMasksByName) {
  const TestFolder folder;
  cv::Mat1b mask(3, 4, uchar{0});
  mask(1, 2) = 7;
  folder.write_image("masks/six.png", mask);
  Drive drive = two_frames();
  match_masks(drive, {folder.path / "none"});
  EXPECT_TRUE(drive.mask_files.empty());
  match_masks(drive, {folder.path / "masks"});
  EXPECT_THAT(drive.mask_files, ElementsAre(fs::path(), folder.path / "masks/six.png"));
  EXPECT_EQ(describe_frames_without_mask(drive), "1 of 2 frames have no mask file, and nothing is removed in them: 5");
  attach_masks(drive, folder.path / "masks");
  EXPECT_EQ(cv::countNonZero(*drive.masks[0]), 0);
  EXPECT_EQ((*drive.masks[1])(1, 2), 255);
}

TEST(MaskFolder, ReadsEndingsInUpperCase) {
  const TestFolder folder;
  folder.write_image("masks/six.PNG", cv::Mat1b(3, 4, uchar{255}));
  Drive drive = two_frames();
  attach_masks(drive, folder.path / "masks");
  EXPECT_EQ(cv::countNonZero(*drive.masks[1]), 12);
}

TEST(MaskFolder, ReadsNamesWithTheEndingOfTheImage) {
  const TestFolder folder;
  for (const char* name : {"five.jpg.png", "six.png.png", "six.png"})
    folder.write_image(std::string("masks/") + name, cv::Mat1b(3, 4, uchar{0}));
  Drive drive = two_frames();
  match_masks(drive, {folder.path / "masks"});
  EXPECT_THAT(drive.mask_files, ElementsAre(folder.path / "masks/five.jpg.png", folder.path / "masks/six.png"));
  EXPECT_TRUE(drive.warnings.empty());
}

TEST(MaskFolder, AcceptsMasksOfMissingImages) {
  const TestFolder folder;
  for (const char* name : {"five", "join", "six"})
    folder.write_image(std::string("masks/") + name + ".png", cv::Mat1b(3, 4, uchar{0}));
  Drive drive = two_frames();
  match_masks(drive, {folder.path / "masks"});
  EXPECT_THAT(drive.mask_files, ElementsAre(folder.path / "masks/five.png", folder.path / "masks/six.png"));
  EXPECT_TRUE(drive.warnings.empty());
  EXPECT_FALSE(describe_frames_without_mask(drive));
}

TEST(MaskFolder, WarnsOfMasksWithoutAFrame) {
  const TestFolder folder;
  for (const char* name : {"five", "early", "sixth"})
    folder.write_image(std::string("masks/") + name + ".png", cv::Mat1b(3, 4, uchar{0}));
  Drive drive = two_frames();
  match_masks(drive, {folder.path / "masks"});
  ASSERT_EQ(drive.warnings.size(), 1U);
  EXPECT_THAT(drive.warnings[0], AllOf(HasSubstr("2 mask files have no image"), HasSubstr("early.png")));
  Drive given = two_frames();
  given.frames[0].file = given.frames[1].file = folder.write("images/sixth.jpg", "an image outside --frames");
  attach_masks(given, folder.path / "masks");
  ASSERT_EQ(given.warnings.size(), 1U);
  EXPECT_THAT(given.warnings[0], AllOf(HasSubstr("1 mask file has no image"), HasSubstr("early.png")));
}

TEST(MaskFolder, FindsMasksInTheFolderAboveOrBelow) {
  const TestFolder folder;
  folder.write_image("masks/six.png", cv::Mat1b(3, 4, uchar{0}));
  make_folder(folder.path / "masks/front");
  Drive drive = two_frames();
  drive.camera_name = "front";
  match_masks(drive, {folder.path / "masks/front"});
  EXPECT_TRUE(drive.mask_files.empty());
  ASSERT_EQ(drive.warnings.size(), 1U);
  EXPECT_THAT(drive.warnings[0], HasSubstr("are not used; move them into " + (folder.path / "masks/front").string()));
  EXPECT_THAT(input_error([&] { attach_masks(drive, folder.path); }),
              HasSubstr("holds no masks; did you mean " + (folder.path / "masks").string()));
}

TEST(MaskFolder, ReadsTheFoldersOfDviMask) {
  const TestFolder folder;
  folder.write_image("masks/front/six.png", cv::Mat1b(3, 4, uchar{255}));
  Drive drive = two_frames();
  drive.camera_name = "front";
  attach_masks(drive, folder.path);
  ASSERT_EQ(drive.mask_files.size(), 2U);
  EXPECT_EQ(std::count_if(drive.mask_files.begin(), drive.mask_files.end(), [](const fs::path& f) { return !f.empty(); }), 1);
}

TEST(MaskFolder, RefusesMasksOfOtherImages) {
  const TestFolder folder;
  folder.write_image("masks/ten.png", cv::Mat1b(3, 4, uchar{0}));
  Drive drive = two_frames();
  EXPECT_THAT(input_error([&] { match_masks(drive, {folder.path / "masks"}); }),
              HasSubstr("ten.png: is not a mask of an image"));
  EXPECT_THAT(input_error([&] { attach_masks(drive, folder.path / "masks"); }),
              AllOf(HasSubstr("ten.png: is not a mask of an image"), HasSubstr("masks are named ten, but images five to six")));
  EXPECT_THAT(input_error([&] { attach_masks(drive, folder.path / "none"); }), HasSubstr("holds no masks"));
  folder.write_image("wrong/six.png", cv::Mat1b(4, 4, uchar{0}));
  attach_masks(drive, folder.path / "wrong");
  EXPECT_THAT(input_error([&] { drive.masks[1]; }), HasSubstr("is 4x4 pixels instead of 4x3"));
}

}  // namespace
}  // namespace dvi::labels
