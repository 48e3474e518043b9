#include "dvi/labels/mask_reading.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include "dvi/core/error.h"
#include "dvi/labels/class_ids.h"
#include "dvi/labels/mask_folder.h"
#include "dvi/testing/image_folder.h"

namespace dvi::labels {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const cv::Size kMaskSize(10, 8);

// Makes a drive with the given number of frames and the masks of a folder.
Drive drive_with(const TestFolder& folder, int frames) {
  Drive drive;
  drive.camera.width = kMaskSize.width, drive.camera.height = kMaskSize.height;
  for (int i = 0; i < frames; ++i) drive.frames.push_back({i, std::to_string(i), i, {}, {}});
  attach_masks(drive, folder.path / "masks");
  drive.warnings.clear();
  return drive;
}

// Makes a mask whose first rows have a value and whose other rows are 0.
cv::Mat1b rows_of(int rows, uchar value = 255) {
  cv::Mat1b mask(kMaskSize, uchar{0});
  mask.rowRange(0, rows) = value;
  return mask;
}

int removed(const Drive& drive, std::size_t frame) { return cv::countNonZero(*drive.masks[frame]); }

std::string usage_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const UsageError& e) {
    return e.what();
  }
  return "no error";
}

// Adds a palette to the PNG of a gray image, whose values become the indices.
std::string with_palette(std::string png, const std::vector<cv::Vec3b>& rgb) {
  const auto number = [](std::uint32_t value) {
    std::string out;
    for (const int shift : {24, 16, 8, 0}) out += static_cast<char>(value >> shift);
    return out;
  };
  const auto chunk = [&](const std::string& body) {  // the body begins with the chunk's name
    return number(static_cast<std::uint32_t>(body.size() - 4)) + body + number(libdeflate_crc32(0, body.data(), body.size()));
  };
  std::string palette = "PLTE";
  for (const cv::Vec3b& color : rgb)
    for (int i = 0; i < 3; ++i) palette += static_cast<char>(color[i]);
  png[25] = 3;
  return png.substr(0, 8) + chunk(png.substr(12, 17)) + chunk(palette) + png.substr(33);
}

TEST(MaskReading, DecidesThePolarityForTheFolder) {
  const TestFolder folder;
  for (int i = 0; i < 5; ++i) folder.write_image(fmt::format("masks/{}.png", i), rows_of(i == 2 ? 8 : 2));
  Drive truck = drive_with(folder, 5);
  read_masks(truck, {});
  EXPECT_EQ(removed(truck, 0), 20);
  EXPECT_EQ(removed(truck, 2), 80) << "a truck fills one frame";
  EXPECT_THAT(truck.warnings, IsEmpty());
  EXPECT_EQ(truck.other_files.size(), 5U) << "the decision depends on them";
  for (int i = 0; i < 5; ++i) folder.write_image(fmt::format("masks/{}.png", i), rows_of(i == 2 ? 0 : 7));
  Drive black = drive_with(folder, 1);  // as --frames 0
  read_masks(black, {});
  EXPECT_EQ(removed(black, 0), 10);
  ASSERT_EQ(black.warnings.size(), 1U);
  EXPECT_THAT(black.warnings[0], AllOf(HasSubstr("black means remove, because 88 %"), HasSubstr("--polarity white")));
}

TEST(MaskReading, UsesTheGivenPolarity) {
  const TestFolder folder;
  for (int i = 0; i < 4; ++i) folder.write_image(fmt::format("masks/{}.png", i), rows_of(6, 1));
  Drive drive = drive_with(folder, 5);
  read_masks(drive, {.polarity = Polarity::white});
  EXPECT_EQ(removed(drive, 0), 60);
  read_masks(drive, {.polarity = Polarity::black});
  EXPECT_EQ(removed(drive, 0), 20);
  EXPECT_EQ(removed(drive, 4), 0) << "nothing is removed in a frame without a file";
  EXPECT_THAT(drive.warnings, IsEmpty());
}

TEST(MaskReading, DoesNotInvertFewMasksOrThoseOfDviMask) {
  const TestFolder folder;
  for (int i = 0; i < 2; ++i) folder.write_image(fmt::format("masks/{}.png", i), rows_of(6));
  Drive few = drive_with(folder, 2);
  read_masks(few, {});
  EXPECT_EQ(removed(few, 0), 60);
  EXPECT_THAT(few.warnings, ElementsAre(AllOf(HasSubstr("75 % of the masks"), HasSubstr("--polarity black"))));
  const TestFolder written;
  written.write("masks.json", "{\n \"schema\": \"dvi-masks/1\"\n}");
  for (int i = 0; i < 4; ++i) written.write_image(fmt::format("masks/front/{}.png", i), rows_of(6));
  Drive drive;
  drive.camera.width = kMaskSize.width, drive.camera.height = kMaskSize.height;
  drive.camera_name = "front";
  for (int i = 0; i < 4; ++i) drive.frames.push_back({i, std::to_string(i), i, {}, {}});
  attach_masks(drive, written.path);
  read_masks(drive, {});
  EXPECT_EQ(removed(drive, 0), 60);
  EXPECT_THAT(drive.warnings, IsEmpty());
}

// An image with road, sky and a car by the ids of Cityscapes, in 3, 4 and 1 rows of 10 pixels.
cv::Mat1b street() {
  cv::Mat1b ids(kMaskSize, uchar{7});
  ids.rowRange(0, 4) = 23;
  ids.row(6) = 26;
  return ids;
}

TEST(MaskReading, RequiresClassesForImagesOfIds) {
  const TestFolder folder;
  folder.write_image("masks/0.png", street());
  Drive drive = drive_with(folder, 1);
  EXPECT_THAT(input_error([&] { read_masks(drive, {}); }),
              AllOf(HasSubstr("0.png: looks like an image of class ids"), HasSubstr("--classes car")));
  read_masks(drive, {.classes = "car"});
  EXPECT_EQ(removed(drive, 0), 10);
  EXPECT_THAT(drive.warnings, IsEmpty());
  read_masks(drive, {.classes = "bus,truck"});
  EXPECT_EQ(removed(drive, 0), 0);
  EXPECT_THAT(drive.warnings, ElementsAre(HasSubstr("none of the 1 inspected images of ids")));
  cv::Mat1b objects = rows_of(1, 1);  // objects on 0
  objects.row(1) = 2, objects.row(2) = 3;
  folder.write_image("masks/0.png", objects);
  Drive instances = drive_with(folder, 1);
  read_masks(instances, {});
  EXPECT_EQ(removed(instances, 0), 30);
  EXPECT_THAT(instances.warnings, ElementsAre(HasSubstr("3 values other than 0, and all of them are removed")));
}

TEST(MaskReading, ReadsInstancesPalettesAndColors) {
  const TestFolder folder;
  const auto with = [&](const cv::Mat& picture, const std::string& classes) {
    folder.write_image("masks/0.png", picture);
    Drive drive = drive_with(folder, 1);
    read_masks(drive, {.classes = classes});
    EXPECT_THAT(drive.warnings, IsEmpty());
    return removed(drive, 0);
  };
  cv::Mat1w deep(kMaskSize, ushort{7});
  deep.row(1) = 26000, deep.row(2) = 26042, deep.row(3) = 24001, deep.row(4) = 26;
  EXPECT_EQ(with(deep, "car"), 30);
  EXPECT_EQ(with(deep, "human,26"), 40);
  cv::Mat4b colored(kMaskSize, cv::Vec4b(128, 64, 128, 255));
  colored.row(2) = cv::Vec4b(142, 0, 0, 255), colored.row(3) = cv::Vec4b(70, 0, 0, 255);
  EXPECT_EQ(with(colored, "car"), 10);
  EXPECT_EQ(with(colored, "vehicle"), 20);
  cv::Mat3b gray;
  cv::merge(std::vector<cv::Mat>(3, street()), gray);
  EXPECT_EQ(with(gray, "car"), 10);

  cv::Mat1b indices(kMaskSize, uchar{0});
  indices.row(5) = 1, indices.row(6) = 2;
  const auto palette = [&](const std::vector<cv::Vec3b>& rgb, const std::string& classes) {
    folder.write("masks/0.png", with_palette(read_file(folder.write_image("gray.png", indices)), rgb));
    Drive drive = drive_with(folder, 1);
    read_masks(drive, {.classes = classes});
    return removed(drive, 0);
  };
  EXPECT_EQ(palette({{128, 64, 128}, {0, 0, 142}, {220, 20, 60}}, "car"), 10) << "by the colors";
  EXPECT_EQ(palette({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, "1,2"), 20) << "by the indices";
}

TEST(MaskReading, ReportsFilesWithoutIds) {
  const TestFolder folder;
  folder.write_image("masks/0.png", rows_of(2));
  Drive plain = drive_with(folder, 1);
  read_masks(plain, {.classes = "car"});
  EXPECT_EQ(removed(plain, 0), 20);
  EXPECT_THAT(plain.warnings, ElementsAre(HasSubstr("--classes is not applied")));
  folder.write_image("masks/0.png", cv::Mat3b(kMaskSize, cv::Vec3b(1, 2, 3)));
  Drive drive = drive_with(folder, 1);
  EXPECT_THAT(input_error([&] { read_masks(drive, {.classes = "car"}); }), HasSubstr("not those of the Cityscapes palette"));
}

TEST(MaskReading, ReadsAStaticMask) {
  const TestFolder folder;
  folder.write_image("masks/0.png", rows_of(0));
  Drive drive = drive_with(folder, 1);
  const auto count = [&](const cv::Mat& mask, Polarity polarity = Polarity::automatic) {
    return cv::countNonZero(read_static_mask(drive, folder.write_image("ego.png", mask), polarity));
  };
  EXPECT_EQ(count(rows_of(2)), 20);
  EXPECT_THAT(drive.warnings, IsEmpty());
  EXPECT_EQ(count(rows_of(6), Polarity::white), 60);
  EXPECT_EQ(count(rows_of(6)), 20);
  EXPECT_THAT(drive.warnings, ElementsAre(HasSubstr("ego.png black means remove")));
  EXPECT_EQ(drive.other_files.back(), folder.path / "ego.png");
  EXPECT_THAT(input_error([&] { count(cv::Mat1b(3, 3, uchar{0})); }), HasSubstr("ego.png: is 3x3 pixels instead of 10x8"));
}

TEST(ClassIds, ParsesNamesGroupsAndNumbersOfTables) {
  EXPECT_THAT(parse_classes("car, Traffic_Light,traffic-sign").ids, ElementsAre(19, 20, 26));
  EXPECT_THAT(parse_classes("kitti-360:trash bin").ids, ElementsAre(39));
  EXPECT_THAT(parse_classes("human").ids, ElementsAre(24, 25));
  EXPECT_THAT(parse_classes("cityscapes-train:car,person").ids, ElementsAre(11, 13));
  EXPECT_THAT(parse_classes("semantic-kitti:car,moving-person").ids, ElementsAre(10, 252, 254));
  EXPECT_THAT(parse_classes("26,1000").ids, ElementsAre(26, 1000));
  EXPECT_THAT(parse_classes("26").colors, ElementsAre(cv::Vec3b(142, 0, 0)));
}

TEST(ClassIds, ListsTheExistingClasses) {
  EXPECT_THAT(usage_error([] { parse_classes("car,wagon"); }), AllOf(HasSubstr("no class 'wagon'"), HasSubstr("truck, bus")));
  EXPECT_THAT(usage_error([] { parse_classes("semantic-kitti:truck,tram"); }),
              AllOf(HasSubstr("'tram'"), HasSubstr("on rails")));
  EXPECT_THAT(usage_error([] { parse_classes("cityscapes-train:caravan"); }), HasSubstr("no class 'caravan'"));
  EXPECT_THAT(usage_error([] { parse_classes("ade20k:car"); }), HasSubstr("no table 'ade20k'"));
  EXPECT_THAT(usage_error([] { parse_classes("car,"); }), HasSubstr("no class ''"));
}

TEST(ClassIds, KeepsLabelsOfTheSelectedTypes) {
  Drive drive;
  drive.frames = {{0, "0", 0, {}, {}}};
  for (const char* type : {"car", "traffic light", "car"}) {
    drive.frames[0].labels.emplace_back();
    drive.frames[0].labels.back().type = type;
  }
  EXPECT_THAT(usage_error([&] { keep_label_types(drive, "wagon"); }),
              AllOf(HasSubstr("'wagon'"), HasSubstr("car, traffic light")));
  drive.warnings.clear();
  keep_label_types(drive, "car,van");
  EXPECT_EQ(drive.frames[0].labels.size(), 2U);
  EXPECT_THAT(drive.warnings, ElementsAre(HasSubstr("no label has the class 'van'")));
}

TEST(KittiIds, AreDistinguishedFromThoseOfCityscapesAndMots) {
  const auto picture = [](const std::vector<ushort>& values) { return cv::Mat(cv::Mat_<ushort>(values, true)); };
  EXPECT_TRUE(are_kitti_ids({picture({768, 768, 6913, 6914}), picture({7937, 0, 1792, 1792})}));
  EXPECT_FALSE(are_kitti_ids({picture({7, 7, 26001, 26002})})) << "Cityscapes";
  EXPECT_FALSE(are_kitti_ids({picture({0, 1001, 2001, 10000})})) << "MOTS";
  EXPECT_FALSE(are_kitti_ids({picture({1792, 1792, 12000})})) << "no class has the id 46";
  EXPECT_FALSE(are_kitti_ids({cv::Mat(1, 4, CV_8UC1, cv::Scalar(26))}));
  EXPECT_FALSE(are_kitti_ids({}));
}

}  // namespace
}  // namespace dvi::labels
