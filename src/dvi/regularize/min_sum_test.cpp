#include "dvi/regularize/min_sum.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/random.h"

namespace dvi::regularize {
namespace {

std::vector<std::int16_t> compute_reference(const std::vector<std::int16_t>& belief, const EdgeColors& edge, int labels,
                                            int stride) {
  std::vector<std::int16_t> out(stride, 0);
  int least = 1 << 30;
  std::vector<int> best(labels, 1 << 30);
  for (int j = 0; j < labels; ++j) {
    for (int i = 0; i < labels; ++i) {
      int cost = belief[i];
      for (int side = 0; side < 2; ++side)
        for (int c = 0; c < 3; ++c) cost += std::abs(edge.sender[side][c * stride + i] - edge.receiver[side][c * stride + j]);
      best[j] = std::min(best[j], cost);
    }
    least = std::min(least, best[j]);
  }
  for (int j = 0; j < labels; ++j) out[j] = static_cast<std::int16_t>(best[j] - least);
  return out;
}

TEST(MinSum, EqualsABruteForceMinimum) {
  Random random(1);
  for (const int labels : {1, 9, 25, 49, 121})
    for (int trial = 0; trial < 50; ++trial) {
      const int stride = (labels + kLanes - 1) / kLanes * kLanes;
      const int spread = trial % 2 == 0 ? 16383 : 600;
      std::vector<std::int16_t> belief(stride), out(stride);
      for (auto& b : belief) b = static_cast<std::int16_t>(random.below(spread));
      std::vector<std::uint8_t> rows[4];
      for (auto& row : rows) {
        row.resize(std::size_t{3} * stride);
        for (auto& v : row) v = static_cast<std::uint8_t>(random.below(trial % 3 == 0 ? 256 : 40));
      }
      const EdgeColors edge{{rows[0].data(), rows[1].data()}, {rows[2].data(), rows[3].data()}};
      compute_message(belief.data(), edge, {labels, stride}, out.data());
      ASSERT_THAT(out, testing::ElementsAreArray(compute_reference(belief, edge, labels, stride))) << labels << " labels";
    }
}

}  // namespace
}  // namespace dvi::regularize
