#include "dvi/labels/scan_labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::labels {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string to_bytes(const std::vector<std::uint32_t>& values) {
  std::string bytes(values.size() * 4, '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

// A drive with two scans. The file of the first one has four points, of which the second is not a return.
class LabeledPoints : public testing::Test {
 protected:
  LabeledPoints() {
    drive.scan_headers.resize(2);
    drive.scan_headers[0].name = "000000";
    drive.scan_headers[1].name = "000001";
    drive.scans = {2, 2, [](std::size_t i) {
                     Scan scan;
                     scan.points.resize(3, {5, 0, 0});
                     if (i == 0) {
                       scan.file_points = 4;
                       scan.file_index = {0, 2, 3};
                     }
                     return scan;
                   }};
  }
  void write(const std::string& name, const std::vector<std::uint32_t>& values) { folder.write(name, to_bytes(values)); }
  void attach(const std::string& classes = "", bool moving_only = false) {
    attach_point_labels(drive, {folder.path}, select_point_classes(classes, moving_only));
  }

  TempFolder folder;
  Drive drive;
};

TEST(ReadPointLabels, AnEmptyFileHasNoLabels) {
  const TempFolder folder;
  folder.write("empty.label", "");
  EXPECT_THAT(read_point_labels(folder.path / "empty.label"), IsEmpty());
}

TEST_F(LabeledPoints, BelongToTheReturnsOfTheirFile) {
  const std::uint32_t moving_car = 7U << 16U | 252U;
  write("000000.label", {10, 252, 40, moving_car});
  write("000001.label", {9, 251, 30});
  attach();
  EXPECT_THAT(drive.point_labels[0]->values, ElementsAre(10, 0, moving_car)) << "road is not removed";
  EXPECT_THAT(drive.point_labels[1]->values, ElementsAre(0, 251, 30));
  EXPECT_THAT(drive.warnings, IsEmpty());
  EXPECT_THAT(drive.other_files, ElementsAre(folder.path / "000000.label", folder.path / "000001.label"));
}

TEST_F(LabeledPoints, AreSelectedByMotionAndClass) {
  write("000000.label", {10, 0, 252, 254});
  write("000001.label", {254, 30, 251});
  attach("", true);
  EXPECT_THAT(drive.point_labels[0]->values, ElementsAre(0, 252, 254));
  EXPECT_THAT(drive.point_labels[1]->values, ElementsAre(254, 0, 251));
  attach("person");
  EXPECT_THAT(drive.point_labels[0]->values, ElementsAre(0, 0, 254)) << "a name includes its moving variant";
  EXPECT_THAT(drive.point_labels[1]->values, ElementsAre(254, 30, 0));
  EXPECT_THROW(select_point_classes("wagon", false), UsageError);
}

TEST_F(LabeledPoints, MissingOrOtherLabelsCauseAWarning) {
  write("000001.label", {1, 1, 4});
  attach();
  EXPECT_THAT(drive.warnings, Contains(HasSubstr("1 of 2 scans have no labels")));
  EXPECT_THAT(drive.warnings, Contains(HasSubstr("their labels are 1, 4; the ids must be those of SemanticKITTI")));
  EXPECT_THAT(drive.point_labels[0]->values, ElementsAre(0, 0, 0));
}

TEST_F(LabeledPoints, ThatDoNotFitTheirScansAreRefused) {
  write("000000.label", {10, 10, 10});
  attach();
  EXPECT_THAT(input_error([&] { drive.point_labels[0]; }), HasSubstr("has 3 labels, but its scan has 4 points"));
  folder.write("000000.label", "seven b");
  EXPECT_THAT(input_error([&] { attach(); }), HasSubstr("7 bytes are not a whole number of labels"));
  drive.scan_headers[0].name = drive.scan_headers[1].name = "other";
  EXPECT_THAT(input_error([&] { attach(); }), HasSubstr("has no label file of a scan of the drive"));
  drive.scan_headers.clear();
  EXPECT_THAT(input_error([&] { attach(); }), HasSubstr("the drive has no scans"));
}

TEST_F(LabeledPoints, AreFoundInTheFoldersThatNetworksWrite) {
  EXPECT_FALSE(find_point_label_folder(folder.path));
  write("sequences/predictions/000000.label", {10});
  EXPECT_EQ(find_point_label_folder(folder.path / "sequences"), folder.path / "sequences/predictions");
  write("sequences/labels/000000.label", {10});
  EXPECT_EQ(find_point_label_folder(folder.path / "sequences"), folder.path / "sequences/labels");
  EXPECT_EQ(find_point_label_folder(folder.path / "sequences/labels"), folder.path / "sequences/labels");
}

}  // namespace
}  // namespace dvi::labels
