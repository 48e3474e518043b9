#include "dvi/io/text.h"

#include "dvi/io/test_folder.h"

namespace dvi::io {
namespace {

using testing::HasSubstr;

TEST(Text, ReadsNumbersWholeOrNotAtAll) {
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
  for (const char* text : {"", ".5", "1e9", "12:30", "1.-5", "4000000001", "9999999999"})
    EXPECT_FALSE(to_nanoseconds(text)) << text;
  EXPECT_EQ(date_to_nanoseconds("2011-09-26 13:10:51.168593664"), 1317042651168593664);
  EXPECT_EQ(date_to_nanoseconds("1970-01-02 00:00:00"), 86'400'000'000'000);
  for (const char* text : {"", "2011-09-26", "2011-13-26 13:10:51.1", "26.09.2011 13:10:51.168", "2011-09-26 24:10:51.1",
                           "2011-09-26 -1:10:51.1", "2011-09-26 13:60:51.1", "2011-09-26 13:10:61.1", "2011-09-26 13:10:-1",
                           "2011-09-26 13:10:4000000000", "2097-09-26 13:10:51.1"})
    EXPECT_FALSE(date_to_nanoseconds(text)) << text;
}

TEST(Text, WritesTimesAsItReadsThem) {
  EXPECT_EQ(to_seconds(1534313591432032000), "1534313591.432032000");
  for (const std::int64_t time : {0L, 1L, -1L, 999'999'999L, -500'000'000L, -1'500'000'000L, 1534313591123456789L})
    EXPECT_EQ(to_nanoseconds(to_seconds(time)), time);
}

TEST(Text, NamesRangesOfNumbers) {
  EXPECT_EQ(ranges({3, 177, 178, 179, 180}), "3, 177-180");
  std::vector<int> many;
  for (int i = 0; i < 20; ++i) many.push_back(2 * i);
  EXPECT_THAT(ranges(many), HasSubstr("22 and 8 more"));
}

TEST(Text, SaysFileAndLineOfWhatIsWrong) {
  const TestFolder folder;
  const fs::path file = folder.write("poses.txt", "# a comment\n1 2 3\r\n1 2 x\n\n");
  const auto lines = read_text_lines(file);
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].numbers<3>(0)[2], 3.0);
  EXPECT_THAT(input_error([&] { lines[1].numbers<3>(0); }), HasSubstr("poses.txt:3: 'x' is not a number"));
  EXPECT_THAT(input_error([&] { lines[2].numbers<3>(0); }), HasSubstr("poses.txt:4: the line is empty"));
  EXPECT_THAT(input_error([&] { lines[0].numbers<4>(0); }), HasSubstr("has 3 entries instead of 4"));
}

}  // namespace
}  // namespace dvi::io
