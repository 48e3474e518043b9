#include "dvi/diagnostics/check_labels.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/diagnostics/test_drive.h"

namespace dvi::diagnostics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(CheckLabels, AcceptsCorrectLabels) {
  EXPECT_THAT(check_labels(make_test_drive(1, 0)), IsEmpty());
  EXPECT_THAT(check_labels(make_test_drive(2, 40)), IsEmpty());
}

TEST(CheckLabels, ReportsLabelsOfAnotherDrive) {
  Drive drive = make_test_drive(1, 0);
  const Drive other = make_test_drive(2, 40);
  for (std::size_t i = 0; i < drive.frames.size(); ++i) drive.frames[i].labels = other.frames[i].labels;
  EXPECT_THAT(check_labels(drive), ElementsAre(HasSubstr("another drive")));
}

TEST(CheckLabels, ReportsLabelsOfOtherFrames) {
  Drive drive = make_test_drive(1, 0);
  const std::vector<Frame> right = drive.frames;
  for (std::size_t i = 0; i < right.size(); ++i) drive.frames[i].labels = right[(i + 7) % right.size()].labels;
  EXPECT_THAT(check_labels(drive), ElementsAre(HasSubstr("other frames")));
}

TEST(CheckLabels, AcceptsLooseLabels) {
  Drive drive = make_test_drive(1, 0);
  for (Frame& frame : drive.frames)
    for (Label& label : frame.labels) label.box->size *= 1.1, label.box->frame_from_box.t.y() += 0.1;
  EXPECT_THAT(check_labels(drive), IsEmpty());
}

TEST(CheckLabels, IgnoresPeople) {
  Drive drive = make_test_drive(1, 0);
  for (Frame& frame : drive.frames)
    for (Label& label : frame.labels) label.box->size = {0.8, 0.6, 1.8}, label.box->frame_from_box.t.y() += 3;
  EXPECT_THAT(check_labels(drive), IsEmpty());
}

TEST(CheckLabels, ReportsNothingForFewOrNoBoxes) {
  Drive drive = make_test_drive(1, 0);
  for (Frame& frame : drive.frames)
    for (Label& label : frame.labels) label.box->frame_from_box.t.z() += 500;
  EXPECT_THAT(check_labels(drive), IsEmpty()) << "out of view";
  for (Frame& frame : drive.frames) frame.labels.clear();
  EXPECT_THAT(check_labels(drive), IsEmpty());
  drive.scan_headers.clear();
  EXPECT_THAT(check_labels(drive), IsEmpty());
}

}  // namespace
}  // namespace dvi::diagnostics
