#include "dvi/drive/nearest_in_time.h"

#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi {
namespace {

struct Item {
  std::int64_t time_ns = 0;
};

TEST(NearestInTime, EqualsTheFirstItemOfALinearSearch) {
  Random random(7);
  for (int round = 0; round < 500; ++round) {
    std::vector<Item> items(random.below(8));
    for (Item& item : items) item.time_ns = static_cast<std::int64_t>(random.below(12));
    std::sort(items.begin(), items.end(), [](const Item& a, const Item& b) { return a.time_ns < b.time_ns; });
    const auto time = static_cast<std::int64_t>(random.below(16)) - 2;
    const auto off = [&](const Item& item) { return std::abs(item.time_ns - time); };
    const auto expected =
        std::min_element(items.begin(), items.end(), [&](const Item& a, const Item& b) { return off(a) < off(b); });
    EXPECT_EQ(nearest_in_time(items.begin(), items.end(), time), expected);
    const Item* const within = nearest_in_time(items, time, 1);
    EXPECT_EQ(within, expected == items.end() || off(*expected) > 1 ? nullptr : &*expected);
  }
}

}  // namespace
}  // namespace dvi
