#include "dvi/core/progress_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(ProgressLine, HasTheTimeLeftOnceTheRateIsKnown) {
  const auto left = [](std::size_t done, std::size_t total, double seconds) {
    return StageProgress{"map", done, total, seconds}.seconds_left();
  };
  EXPECT_FALSE(left(1, 100, 2)) << "one unit is not enough";
  EXPECT_FALSE(left(3, 1000, 60)) << "less than 2 %";
  EXPECT_FALSE(left(50, 1000, 0.01)) << "the first units may have been cached";
  EXPECT_FALSE(left(0, 10, 60));
  EXPECT_FALSE(left(10, 10, 60)) << "nothing is left";
  EXPECT_FALSE(left(19, 0, 60)) << "unknown total";
  EXPECT_DOUBLE_EQ(left(3, 12, 6).value_or(0), 18);
  EXPECT_DOUBLE_EQ(left(1, 4, 60).value_or(0), 180) << "one slow unit is enough";
}

TEST(ProgressLine, FormatsDurations) {
  EXPECT_EQ(format_duration(9.6), "10 s");
  EXPECT_EQ(format_duration(125), "2:05 min");
  EXPECT_EQ(format_duration(4020), "1:07 h");
}

TEST(ProgressLine, DoesNotReachTheLastColumn) {
  for (const StageProgress& at : {StageProgress{"odometry", 471, 1200, 250}, StageProgress{"eval oncoming", 5, 0, 3},
                                  StageProgress{"fill", 3, 100000, 7000}, StageProgress{"normals", 0, 0, 0}})
    for (std::size_t columns = 1; columns < 120; ++columns)
      for (const bool ended : {false, true})
        EXPECT_LT(format_bar_line(at, ended, columns).size(), columns) << at.stage << columns;
}

TEST(ProgressLine, OmitsPartsOnNarrowTerminals) {
  const StageProgress at{"odometry", 471, 1200, 250};
  EXPECT_EQ(format_bar_line(at, false, 80), "odometry   [###########...................] 471/1200  1.9/s  6:27 min left");
  EXPECT_EQ(format_bar_line(at, false, 50), "odometry   [####........] 471/1200  6:27 min left");
  EXPECT_EQ(format_bar_line(at, false, 38), "odometry   471/1200  6:27 min left");
  EXPECT_EQ(format_bar_line(at, false, 24), "odometry   471/1200");
}

TEST(ProgressLine, HasTheNumberOfTheStageAndTheTimeOfTheRun) {
  const StageProgress at{"fill", 34, 120, 40, RunProgress{12, 15, 80}};
  EXPECT_EQ(format_bar_line(at, false, 80), "12/15 fill [########......................] 34/120  1.2 s each  1:20 min left");
  EXPECT_EQ(format_bar_line(at, false, 45), "12/15 fill [##.......] 34/120  1:20 min left");
  EXPECT_EQ(format_log_line(at, false), "12/15 fill: 34 of 120, 1.2 s each, 1:20 min left");
  const StageProgress unsure{"fill", 1, 120, 2, RunProgress{12, 15, {}}};
  EXPECT_THAT(format_bar_line(unsure, false, 80), Not(HasSubstr("left")));
}

TEST(ProgressLine, HasNoBarBeforeTheFirstUnit) {
  EXPECT_EQ(format_bar_line({"fill", 0, 120, 2}, false, 80), "fill       0/120");
}

TEST(ProgressLine, HasNoBarForAnUnknownTotal) {
  for (const std::string& line : {format_bar_line({"eval", 19, 0, 3}, false, 80), format_log_line({"eval", 19, 0, 3}, false)}) {
    EXPECT_THAT(line, HasSubstr("19"));
    EXPECT_THAT(line, Not(testing::AnyOf(HasSubstr("of 0"), HasSubstr("/0"), HasSubstr("[."))));
  }
  EXPECT_EQ(format_bar_line({"normals", 0, 0, 0}, false, 80), "normals   ");
  EXPECT_EQ(format_bar_line({"normals", 0, 0, 7}, true, 80), "normals     7 s");
}

TEST(ProgressLine, FormatsCountAndRateInLogs) {
  EXPECT_EQ(format_log_line({"map", 30, 100, 2.5}, false), "map: 30 of 100, 12.0/s, 6 s left");
  EXPECT_EQ(format_log_line({"fill", 1, 100, 6}, false), "fill: 1 of 100, 6.0 s each");
  EXPECT_EQ(format_log_line({"map", 100, 100, 9}, true), "map: done, 9 s");
}

}  // namespace
}  // namespace dvi
