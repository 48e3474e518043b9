#include "dvi/regularize/belief_propagation.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/regularize/min_sum.h"
#include "dvi/regularize/shift_field.h"
#include "dvi/regularize/tree_reweighted.h"

namespace dvi::regularize {
namespace {

/// A grid of nodes with random costs and colors.
ShiftField random_field(int width, int height, std::uint64_t seed) {
  Random random(seed);
  ShiftField field;
  field.shifts = window_shifts(3);
  field.stride = kLanes;  // 9 labels
  const int nodes = width * height;
  int rows = nodes;
  for (int i = 0; i < nodes; ++i) {
    const int x = i % width, y = i / width;
    field.pixel.push_back(i);
    field.neighbor.push_back(
        {x > 0 ? i - 1 : -1, y > 0 ? i - width : -1, x + 1 < width ? i + 1 : -1, y + 1 < height ? i + width : -1});
    field.expected.push_back({-1, -1, -1, -1});
    for (int d = 0; d < 4; ++d)
      if (field.neighbor[i][d] >= 0 && random.uniform() < 0.9) field.expected[i][d] = rows++;
  }
  field.colors.resize(static_cast<std::size_t>(rows) * 3 * field.stride);
  for (auto& v : field.colors) v = static_cast<std::uint8_t>(random.below(256));
  field.data.resize(static_cast<std::size_t>(nodes) * field.stride);
  for (auto& v : field.data) v = static_cast<std::int16_t>(random.below(765));
  return field;
}

double least_energy(const ShiftField& field) {
  std::vector<int> labels(field.nodes(), 0);
  double least = energy(field, labels);
  for (std::size_t digit = 0; digit < labels.size();) {
    if (++labels[digit] == field.labels()) {
      labels[digit++] = 0;
      continue;
    }
    digit = 0;
    least = std::min(least, energy(field, labels));
  }
  return least;
}

TEST(BeliefPropagation, IsExactOnChains) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const ShiftField field = seed % 2 == 0 ? random_field(4, 1, seed) : random_field(1, 4, seed);
    const double least = least_energy(field);
    const BeliefPropagation found = propagate(field, 20);
    EXPECT_EQ(found.energy_after, least);
    EXPECT_LT(found.iterations, 20) << "a chain converges";
    EXPECT_EQ(found.energy_after, energy(field, found.labels));
  }
}

TEST(BeliefPropagation, IsNearTheOptimumOnLoops) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ShiftField field = random_field(2, 2, seed);
    EXPECT_LE(propagate(field, 50).energy_after, 1.1 * least_energy(field));
  }
}

TEST(BeliefPropagation, ComesNearToAStrongerSolver) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ShiftField field = random_field(12, 9, seed);
    const TreeReweighted judge(field, 50);
    EXPECT_LE(judge.bound(), judge.energy());
    const double found = propagate(field, 50).energy_after;
    EXPECT_LE(judge.bound(), found);
    EXPECT_LE(found, 1.05 * judge.energy()) << judge.bound();
  }
}

TEST(BeliefPropagation, NeverMakesTheEnergyWorse) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ShiftField field = random_field(8, 6, seed);
    double last = energy(field, std::vector<int>(field.nodes(), 0));
    for (const int iterations : {1, 2, 5, 20}) {
      const BeliefPropagation found = propagate(field, iterations);
      EXPECT_LE(found.energy_after, last);
      EXPECT_EQ(found.energy_after, energy(field, found.labels));
      last = found.energy_after;
    }
  }
}

TEST(TreeReweighted, IsExactOnChains) {
  const ShiftField field = random_field(4, 1, 1);
  const TreeReweighted found(field, 20);
  EXPECT_EQ(found.energy(), least_energy(field));
  EXPECT_NEAR(found.bound(), found.energy(), 1e-6);
  EXPECT_EQ(found.energy(), energy(field, found.labels()));
}

TEST(TreeReweighted, BoundsTheLeastEnergyOnLoops) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ShiftField field = random_field(2, 2, seed);
    const TreeReweighted found(field, 50);
    const double least = least_energy(field);
    EXPECT_LE(found.bound(), least + 1e-6);
    EXPECT_GT(found.bound(), 0.9 * least);
    EXPECT_GE(found.energy(), least);
    EXPECT_EQ(found.energy(), energy(field, found.labels()));
  }
}

TEST(BeliefPropagation, CountsTheEdgeOnceFromEitherSide) {
  const ShiftField field = random_field(2, 1, 3);
  int cost = field.data_of(0)[1] + field.data_of(1)[2];
  for (int c = 0; c < 3; ++c) {
    const int at = c * field.stride;
    if (field.expected[0][2] >= 0) cost += std::abs(field.row(field.expected[0][2])[at + 1] - field.row(1)[at + 2]);
    if (field.expected[1][0] >= 0) cost += std::abs(field.row(field.expected[1][0])[at + 2] - field.row(0)[at + 1]);
  }
  EXPECT_EQ(energy(field, {1, 2}), cost);
}

}  // namespace
}  // namespace dvi::regularize
