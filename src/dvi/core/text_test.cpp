#include "dvi/core/text.h"

#include <gmock/gmock.h>

#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using testing::HasSubstr;

TEST(Text, ReadsOnlyCompleteNumbers) {
  EXPECT_EQ(to_number("-1.5e2"), -150.0);
  EXPECT_EQ(to_number("+3"), 3.0);
  for (const char* text : {"", "nan", "inf", "1.5m", "1,5", "--1"}) EXPECT_FALSE(to_number(text)) << text;
  EXPECT_EQ(to_integer("0012"), 12);
  EXPECT_FALSE(to_integer("99999999999"));
}

TEST(Text, ReadsTimesExactly) {
  EXPECT_EQ(to_nanoseconds("1534313591.432032"), 1534313591432032000);
  EXPECT_EQ(to_nanoseconds("1534313591.123456789"), 1534313591123456789);
  EXPECT_EQ(to_nanoseconds("0.1234567891"), 123456789);
  EXPECT_EQ(to_nanoseconds("-0.5"), -500'000'000);
  EXPECT_EQ(to_nanoseconds(".5"), 500'000'000);
  EXPECT_EQ(to_nanoseconds("+5."), 5'000'000'000);
  for (const char* text : {"", ".", "12:30", "1.-5", "4000000001", "9999999999", "1534313591432032000", "1e10", "1e", "1e1.5",
                           "e5", "1e99999999999", "nan", "0x10", "+-5"})
    EXPECT_FALSE(to_nanoseconds(text)) << text;
  EXPECT_EQ(date_to_nanoseconds("2011-09-26 13:10:51.168593664"), 1317042651168593664);
  EXPECT_EQ(date_to_nanoseconds("1970-01-02 00:00:00"), 86'400'000'000'000);
  for (const char* text : {"", "2011-09-26", "2011-13-26 13:10:51.1", "26.09.2011 13:10:51.168", "2011-09-26 24:10:51.1",
                           "2011-09-26 -1:10:51.1", "2011-09-26 13:60:51.1", "2011-09-26 13:10:61.1", "2011-09-26 13:10:-1",
                           "2011-09-26 13:10:4000000000", "2097-09-26 13:10:51.1"})
    EXPECT_FALSE(date_to_nanoseconds(text)) << text;
}

// The formats are those of times.txt of KITTI's odometry benchmark ("1.036224e-01"), and of evo, which prints "%.18e".
TEST(Text, ReadsTimesInScientificNotationExactly) {
  EXPECT_EQ(to_nanoseconds("0.000000e+00"), 0);
  EXPECT_EQ(to_nanoseconds("1.036224e-01"), 103'622'400);
  EXPECT_EQ(to_nanoseconds("1.305031102175304000e+09"), 1305031102175304000);
  EXPECT_EQ(to_nanoseconds("1.305031102175303936e+09"), 1305031102175303936);
  EXPECT_EQ(to_nanoseconds("-2.5E-1"), -250'000'000);
  EXPECT_EQ(to_nanoseconds("1e9"), 1'000'000'000'000'000'000);
  EXPECT_EQ(to_nanoseconds("1e-10"), 0);
  EXPECT_EQ(to_nanoseconds("1e-999999"), 0);
  EXPECT_EQ(to_nanoseconds("0e999999"), 0);
}

TEST(Text, WritesTimesThatItReadsBack) {
  EXPECT_EQ(to_seconds(1534313591432032000), "1534313591.432032000");
  for (const std::int64_t time : {0L, 1L, -1L, 999'999'999L, -500'000'000L, -1'500'000'000L, 1534313591123456789L})
    EXPECT_EQ(to_nanoseconds(to_seconds(time)), time);
}

TEST(Text, SplitsListsAtCommas) {
  EXPECT_EQ(split_at_commas("car,traffic light"), (std::vector<std::string>{"car", "traffic light"}));
  EXPECT_EQ(split_at_commas("a,,b,"), (std::vector<std::string>{"a", "", "b", ""}));
  EXPECT_EQ(split_at_commas(""), std::vector<std::string>{""});
}

TEST(Text, FormatsRangesOfNumbers) {
  EXPECT_EQ(format_ranges({3, 177, 178, 179, 180}), "3, 177-180");
  std::vector<int> many;
  for (int i = 0; i < 20; ++i) many.push_back(2 * i);
  EXPECT_THAT(format_ranges(many), HasSubstr("22 and 8 more"));
}

TEST(Text, ReportsFileAndLineOfErrors) {
  const TempFolder folder;
  const fs::path file = folder.write("poses.txt", "# a comment\n1 2 3\r\n1 2 x\n\n");
  const auto lines = read_text_lines(file);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].numbers<3>(0)[2], 3.0);
  EXPECT_THAT(input_error([&] { lines[1].numbers<3>(0); }), HasSubstr("poses.txt:3: 'x' is not a number"));
  EXPECT_THAT(input_error([&] { lines[2].numbers<3>(0); }), HasSubstr("poses.txt:4: the line is empty"));
  EXPECT_THAT(input_error([&] { lines[0].numbers<4>(0); }), HasSubstr("has 3 entries instead of 4"));
  EXPECT_THAT(input_error([&] { lines[1].nanoseconds(2); }), HasSubstr("poses.txt:3: 'x' is not a time in seconds"));
  const auto counted = read_text_lines(folder.write("times.txt", "1534313591432032000\n"));
  EXPECT_THAT(input_error([&] { counted[0].nanoseconds(0); }),
              HasSubstr("in nanoseconds; write seconds, such as 1534313591.432"));
  const auto large = read_text_lines(folder.write("times.txt", "9999999999999999999\n"));
  EXPECT_THAT(input_error([&] { large[0].nanoseconds(0); }), HasSubstr("a time is a number such as"));
}

TEST(Text, RefusesVeryLongLines) {
  const TempFolder folder;
  std::string line(kMaxLineBytes, '1');
  EXPECT_EQ(read_text_lines(folder.write("a.txt", line + "\n")).size(), 1U);
  const fs::path file = folder.write("b.txt", "1 2\n" + line + " 1\n");
  EXPECT_THAT(input_error([&] { read_text_lines(file); }), HasSubstr("b.txt:2: the line has 1048578 bytes"));
}

}  // namespace
}  // namespace dvi
