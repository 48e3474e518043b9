#include "dvi/core/natural_order.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi {
namespace {

using testing::ElementsAre;

std::vector<std::string> sort_naturally(std::vector<std::string> names) {
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

TEST(NaturalOrder, ComparesNumbersByValue) {
  EXPECT_THAT(sort_naturally({"frame10", "frame1", "frame2", "frame20"}),
              ElementsAre("frame1", "frame2", "frame10", "frame20"));
  EXPECT_THAT(sort_naturally({"a2b10", "a2b9", "a10b1", "a1"}), ElementsAre("a1", "a2b9", "a2b10", "a10b1"));
}

TEST(NaturalOrder, ComparesDigitsAfterAPointAsDecimals) {
  EXPECT_THAT(sort_naturally({"7.5", "7.25", "10.1", "7"}), ElementsAre("7", "7.25", "7.5", "10.1"));
  EXPECT_THAT(sort_naturally({"frame.10.png", "frame.9.png"}), ElementsAre("frame.9.png", "frame.10.png"));
}

TEST(NaturalOrder, EqualsTheLexicographicOrderForNumbersOfEqualWidth) {
  std::vector<std::string> names = {"000010", "000002", "b", "a-1", "a.1", "", "x_07", "x_11", "\xC3\xA4"};
  std::vector<std::string> plain = names;
  std::sort(plain.begin(), plain.end());
  EXPECT_EQ(sort_naturally(names), plain);
}

// A comparator that is not a strict weak ordering would make a set lose or repeat names.
TEST(NaturalOrder, KeepsNamesThatDifferInLeadingZeros) {
  const std::set<std::string, NaturalLess> names = {"1", "01", "001", "1", "2"};
  EXPECT_THAT(names, ElementsAre("001", "01", "1", "2"));
}

}  // namespace
}  // namespace dvi
