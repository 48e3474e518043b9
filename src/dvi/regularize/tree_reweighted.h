#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include "dvi/regularize/shift_field.h"

namespace dvi::regularize {

/// Sequential tree-reweighted message passing (TRW-S: Kolmogorov, Convergent tree-reweighted message passing for energy
/// minimization, PAMI 2006). It judges belief propagation in tests and benchmarks: it shares no code with it, is slower, and
/// tells how low any energy can be.
class TreeReweighted {
 public:
  TreeReweighted(const ShiftField& field, int iterations)
      : field_(field),
        labels_(field.labels()),
        incoming_(field.nodes() * 4 * labels_),
        chosen_(field.nodes(), 0),
        best_(chosen_) {
    energy_ = energy_of(chosen_);
    for (int k = 0; k < iterations; ++k) {
      forward();
      if (const double found = energy_of(chosen_); found < energy_) {
        energy_ = found;
        best_ = chosen_;
      }
      bound_ = std::max(bound_, backward());
    }
  }

  /// The cheapest labeling met, and what it costs.
  const std::vector<int>& labels() const { return best_; }
  double energy() const { return energy_; }
  /// No labeling costs less.
  double bound() const { return bound_; }

 private:
  static constexpr int kAhead = 2;  // of the directions: right and below

  double cost(std::size_t node, int direction, int own, int others) const {
    const int other = field_.neighbor[node][direction];
    const int forth = field_.expected[node][direction], back = field_.expected[other][direction ^ 2];
    int sum = 0;
    for (int c = 0; c < 3; ++c) {
      const int i = c * field_.stride + own, j = c * field_.stride + others;
      if (forth >= 0) sum += std::abs(field_.row(forth)[i] - field_.row(other)[j]);
      if (back >= 0) sum += std::abs(field_.row(back)[j] - field_.row(static_cast<int>(node))[i]);
    }
    return sum;
  }

  double energy_of(const std::vector<int>& of) const {
    double sum = 0;
    for (std::size_t node = 0; node < field_.nodes(); ++node) {
      sum += field_.data_of(node)[of[node]];
      for (int d = kAhead; d < 4; ++d)
        if (const int other = field_.neighbor[node][d]; other >= 0) sum += cost(node, d, of[node], of[other]);
    }
    return sum;
  }

  double* message(std::size_t node, int direction) { return &incoming_[(node * 4 + direction) * labels_]; }

  // Data cost and all messages.
  std::vector<double> belief(std::size_t node) {
    std::vector<double> out(field_.data_of(node), field_.data_of(node) + labels_);
    for (int d = 0; d < 4; ++d)
      if (field_.neighbor[node][d] >= 0)
        for (int i = 0; i < labels_; ++i) out[i] += message(node, d)[i];
    return out;
  }

  // The share of a node's belief that each of the trees through it, which are chains in raster order, gets.
  double share(std::size_t node) const {
    std::array<int, 2> count{};
    for (int d = 0; d < 4; ++d) count[d / kAhead] += field_.neighbor[node][d] >= 0;
    return 1.0 / std::max({count[0], count[1], 1});
  }

  // Tells a neighbor; the least of the message is taken out of it and returned.
  double send(std::size_t node, int direction, const std::vector<double>& belief) {
    const int other = field_.neighbor[node][direction];
    const double part = share(node);
    std::vector<double> out(labels_, std::numeric_limits<double>::max());
    for (int i = 0; i < labels_; ++i) {
      const double own = part * belief[i] - message(node, direction)[i];
      for (int j = 0; j < labels_; ++j) out[j] = std::min(out[j], own + cost(node, direction, i, j));
    }
    const double least = *std::min_element(out.begin(), out.end());
    for (int j = 0; j < labels_; ++j) message(other, direction ^ 2)[j] = out[j] - least;
    return least;
  }

  // In raster order; chooses the label that is cheapest given those chosen before.
  void forward() {
    for (std::size_t node = 0; node < field_.nodes(); ++node) {
      std::vector<double> given(field_.data_of(node), field_.data_of(node) + labels_);
      for (int d = 0; d < 4; ++d) {
        const int other = field_.neighbor[node][d];
        if (other < 0) continue;
        for (int i = 0; i < labels_; ++i) given[i] += d < kAhead ? cost(node, d, i, chosen_[other]) : message(node, d)[i];
      }
      chosen_[node] = static_cast<int>(std::min_element(given.begin(), given.end()) - given.begin());
      const std::vector<double> all = belief(node);
      for (int d = kAhead; d < 4; ++d)
        if (field_.neighbor[node][d] >= 0) send(node, d, all);
    }
  }

  // The other way. Returns the bound: what is taken out of all messages and beliefs.
  double backward() {
    double sum = 0;
    for (std::size_t node = field_.nodes(); node-- > 0;) {
      std::vector<double> all = belief(node);
      const double least = *std::min_element(all.begin(), all.end());
      for (double& value : all) value -= least;
      sum += least;
      for (int d = 0; d < kAhead; ++d)
        if (field_.neighbor[node][d] >= 0) sum += send(node, d, all);
    }
    return sum;
  }

  const ShiftField& field_;
  int labels_;
  std::vector<double> incoming_;
  std::vector<int> chosen_, best_;
  double energy_ = 0, bound_ = 0;
};

}  // namespace dvi::regularize
