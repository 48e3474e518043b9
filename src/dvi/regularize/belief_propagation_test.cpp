#include "dvi/regularize/belief_propagation.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/regularize/min_sum.h"
#include "dvi/regularize/shift_field.h"
#include "dvi/regularize/test_tree_reweighted.h"

namespace dvi::regularize {
namespace {

/// A grid of nodes with random costs and colors.
ShiftField random_field(int width, int height, std::uint64_t seed) {
  Random random(seed);
  ShiftField field;
  field.shifts = list_shifts(3);
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

/// Computes the lowest energy by enumeration of all labels.
double enumerate_min_energy(const ShiftField& field) {
  std::vector<int> labels(field.nodes(), 0);
  double min_energy = compute_energy(field, labels);
  for (std::size_t digit = 0; digit < labels.size();) {
    if (++labels[digit] == field.labels()) {
      labels[digit++] = 0;
      continue;
    }
    digit = 0;
    min_energy = std::min(min_energy, compute_energy(field, labels));
  }
  return min_energy;
}

TEST(BeliefPropagation, IsExactOnChains) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const ShiftField field = seed % 2 == 0 ? random_field(4, 1, seed) : random_field(1, 4, seed);
    const double min_energy = enumerate_min_energy(field);
    const BeliefPropagation found = propagate_beliefs(field, 20);
    EXPECT_EQ(found.energy_after, min_energy);
    EXPECT_LT(found.iterations, 20) << "a chain converges";
    EXPECT_EQ(found.energy_after, compute_energy(field, found.labels));
  }
}

TEST(BeliefPropagation, IsNearTheOptimumOnLoops) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ShiftField field = random_field(2, 2, seed);
    EXPECT_LE(propagate_beliefs(field, 50).energy_after, 1.1 * enumerate_min_energy(field));
  }
}

TEST(BeliefPropagation, IsNearTheResultOfAStrongerSolver) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ShiftField field = random_field(12, 9, seed);
    const TreeReweighted reference(field, 50);
    EXPECT_LE(reference.bound(), reference.energy());
    const double found = propagate_beliefs(field, 50).energy_after;
    EXPECT_LE(reference.bound(), found);
    EXPECT_LE(found, 1.05 * reference.energy()) << reference.bound();
  }
}

TEST(BeliefPropagation, NeverIncreasesTheEnergy) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const ShiftField field = random_field(8, 6, seed);
    double last = compute_energy(field, std::vector<int>(field.nodes(), 0));
    for (const int iterations : {1, 2, 5, 20}) {
      const BeliefPropagation found = propagate_beliefs(field, iterations);
      EXPECT_LE(found.energy_after, last);
      EXPECT_EQ(found.energy_after, compute_energy(field, found.labels));
      last = found.energy_after;
    }
  }
}

TEST(TreeReweighted, IsExactOnChains) {
  const ShiftField field = random_field(4, 1, 1);
  const TreeReweighted found(field, 20);
  EXPECT_EQ(found.energy(), enumerate_min_energy(field));
  EXPECT_NEAR(found.bound(), found.energy(), 1e-6);
  EXPECT_EQ(found.energy(), compute_energy(field, found.labels()));
}

TEST(TreeReweighted, BoundsTheMinimumEnergyOnLoops) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const ShiftField field = random_field(2, 2, seed);
    const TreeReweighted found(field, 50);
    const double min_energy = enumerate_min_energy(field);
    EXPECT_LE(found.bound(), min_energy + 1e-6);
    EXPECT_GT(found.bound(), 0.9 * min_energy);
    EXPECT_GE(found.energy(), min_energy);
    EXPECT_EQ(found.energy(), compute_energy(field, found.labels()));
  }
}

TEST(BeliefPropagation, CountsEachEdgeOnce) {
  const ShiftField field = random_field(2, 1, 3);
  int cost = field.data_of(0)[1] + field.data_of(1)[2];
  for (int c = 0; c < 3; ++c) {
    const int at = c * field.stride;
    if (field.expected[0][2] >= 0) cost += std::abs(field.row(field.expected[0][2])[at + 1] - field.row(1)[at + 2]);
    if (field.expected[1][0] >= 0) cost += std::abs(field.row(field.expected[1][0])[at + 2] - field.row(0)[at + 1]);
  }
  EXPECT_EQ(compute_energy(field, {1, 2}), cost);
}

}  // namespace
}  // namespace dvi::regularize
