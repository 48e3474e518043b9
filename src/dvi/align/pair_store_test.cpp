#include "dvi/align/pair_store.h"

#include <gtest/gtest.h>

namespace dvi::align {
namespace {

TEST(PairStore, HasNearAndFarPartnersOnBothSides) {
  const auto partners = [](std::size_t view, std::size_t count, std::vector<std::vector<std::size_t>> anchors = {}) {
    const Partners all{count, std::move(anchors)};
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < kPartners + kAnchors; ++k)
      if (const auto partner = all.get(view, k)) out.push_back(*partner);
    return out;
  };
  EXPECT_EQ(partners(10, 100), (std::vector<std::size_t>{9, 11, 8, 12, 6, 14, 2, 18}));
  EXPECT_EQ(Partners({.count = 100, .max_distance = 32}).get(40, 11), 72U);
  EXPECT_EQ(Partners({.count = 100}).get(40, 11), std::nullopt);
  EXPECT_EQ(partners(0, 6), (std::vector<std::size_t>{1, 2, 4}));
  EXPECT_EQ(partners(0, 1), std::vector<std::size_t>{});
  EXPECT_EQ(partners(1, 2, {{2}, {3, 2}}), (std::vector<std::size_t>{0, 3, 2}));
}

// Partners observe every second, third, and fifth of 100 points; fewer than kMinPairPoints make no pair.
TEST(PairStore, ReturnsTheAddedPairs) {
  map::StaticMap map(std::make_shared<Scratch>(0));
  for (int i = 0; i < 200; ++i) {
    map.points.emplace_back();
    map.points.back().position = {static_cast<float>(i), 0, 0};
    map.points.back().normal = {0, 0, static_cast<float>(-i)};
  }
  PairStore store(map, {.count = 20});
  for (std::size_t view = 0; view < 20; ++view) {
    std::vector<SharedPoint> points;
    for (std::size_t i = 0; i < 100; ++i) {
      const int seen = (i % 2 == 0 ? 1 : 8) + (i % 5 == 0 ? 2 : 0);
      points.push_back({.index = i + view, .observed_by = static_cast<std::uint16_t>(seen)});
    }
    store.add(points);
  }
  const std::vector<Pair> pairs = store.get_pairs(10);
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].moving, 10U);
  EXPECT_EQ(pairs[0].fixed, 9U);
  EXPECT_EQ(pairs[1].fixed, 12U);
  for (std::size_t p = 0; p < 2; ++p) {
    ASSERT_EQ(pairs[p].visible.size(), 50U);
    for (std::size_t i = 0; i < 50; ++i) {
      const SurfacePoint& point = (*pairs[p].points)[pairs[p].visible[i]];
      const auto expected = static_cast<float>(10 + 2 * i + p);
      EXPECT_EQ(point.position.x(), expected);
      EXPECT_EQ(point.normal.z(), -expected);
    }
  }
  ASSERT_EQ(store.get_pairs(0).size(), 1U);
  EXPECT_EQ(store.get_pairs(0)[0].fixed, 2U);
}

}  // namespace
}  // namespace dvi::align
