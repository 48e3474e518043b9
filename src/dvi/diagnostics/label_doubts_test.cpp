#include "dvi/diagnostics/label_doubts.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/diagnostics/test_drive.h"

namespace dvi::diagnostics {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(LabelDoubts, RightLabelsAreNotDoubted) {
  EXPECT_THAT(label_doubts(test_drive(1, 0)), IsEmpty());
  EXPECT_THAT(label_doubts(test_drive(2, 40)), IsEmpty());
}

TEST(LabelDoubts, LabelsOfAnotherDriveAreSaid) {
  Drive drive = test_drive(1, 0);
  const Drive other = test_drive(2, 40);
  for (std::size_t i = 0; i < drive.frames.size(); ++i) drive.frames[i].labels = other.frames[i].labels;
  EXPECT_THAT(label_doubts(drive), ElementsAre(HasSubstr("another drive")));
}

TEST(LabelDoubts, LabelsOfOtherFramesAreSaid) {
  Drive drive = test_drive(1, 0);
  const std::vector<Frame> right = drive.frames;
  for (std::size_t i = 0; i < right.size(); ++i) drive.frames[i].labels = right[(i + 7) % right.size()].labels;
  EXPECT_THAT(label_doubts(drive), ElementsAre(HasSubstr("other frames")));
}

TEST(LabelDoubts, LooseLabelsAreNotDoubted) {
  Drive drive = test_drive(1, 0);
  for (Frame& frame : drive.frames)
    for (Label& label : frame.labels) label.box->size *= 1.1, label.box->frame_from_box.t.y() += 0.1;
  EXPECT_THAT(label_doubts(drive), IsEmpty());
}

TEST(LabelDoubts, PeopleTellNothing) {
  Drive drive = test_drive(1, 0);
  for (Frame& frame : drive.frames)
    for (Label& label : frame.labels) label.box->size = {0.8, 0.6, 1.8}, label.box->frame_from_box.t.y() += 3;
  EXPECT_THAT(label_doubts(drive), IsEmpty());
}

TEST(LabelDoubts, FewOrNoBoxesTellNothing) {
  Drive drive = test_drive(1, 0);
  for (Frame& frame : drive.frames)
    for (Label& label : frame.labels) label.box->frame_from_box.t.z() += 500;
  EXPECT_THAT(label_doubts(drive), IsEmpty()) << "out of sight";
  for (Frame& frame : drive.frames) frame.labels.clear();
  EXPECT_THAT(label_doubts(drive), IsEmpty());
  drive.scan_headers.clear();
  EXPECT_THAT(label_doubts(drive), IsEmpty());
}

}  // namespace
}  // namespace dvi::diagnostics
