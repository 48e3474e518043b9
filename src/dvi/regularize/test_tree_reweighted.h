#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include "dvi/regularize/shift_field.h"

namespace dvi::regularize {

/// Sequential tree-reweighted message passing (TRW-S: V. Kolmogorov, Convergent tree-reweighted message passing for energy
/// minimization, PAMI 2006). It is the reference for belief propagation in tests and benchmarks: it shares no code with it, is
/// slower, and computes a lower bound of the energy.
class TreeReweighted {
 public:
  TreeReweighted(const ShiftField& field, int iterations)
      : field_(field),
        labels_(field.labels()),
        incoming_(field.nodes() * 4 * labels_),
        selected_(field.nodes(), 0),
        best_(selected_) {
    energy_ = energy_of(selected_);
    for (int k = 0; k < iterations; ++k) {
      pass_forward();
      if (const double found = energy_of(selected_); found < energy_) {
        energy_ = found;
        best_ = selected_;
      }
      bound_ = std::max(bound_, pass_backward());
    }
  }

  /// The labels with the lowest energy of all iterations, and that energy.
  const std::vector<int>& labels() const { return best_; }
  double energy() const { return energy_; }
  /// A lower bound of the energy of any labels.
  double bound() const { return bound_; }

 private:
  static constexpr int kFirstAhead = 2;  // the first of the directions right and down

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

  double energy_of(const std::vector<int>& labels) const {
    double sum = 0;
    for (std::size_t node = 0; node < field_.nodes(); ++node) {
      sum += field_.data_of(node)[labels[node]];
      for (int d = kFirstAhead; d < 4; ++d)
        if (const int other = field_.neighbor[node][d]; other >= 0) sum += cost(node, d, labels[node], labels[other]);
    }
    return sum;
  }

  double* message(std::size_t node, int direction) { return &incoming_[(node * 4 + direction) * labels_]; }

  /// Sums the data cost and all messages of a node.
  std::vector<double> compute_belief(std::size_t node) {
    std::vector<double> out(field_.data_of(node), field_.data_of(node) + labels_);
    for (int d = 0; d < 4; ++d)
      if (field_.neighbor[node][d] >= 0)
        for (int i = 0; i < labels_; ++i) out[i] += message(node, d)[i];
    return out;
  }

  /// The share of a node's belief in each of the trees through it, which are chains in raster order.
  double share(std::size_t node) const {
    std::array<int, 2> count{};
    for (int d = 0; d < 4; ++d) count[d / kFirstAhead] += field_.neighbor[node][d] >= 0;
    return 1.0 / std::max({count[0], count[1], 1});
  }

  /// Sends a message to a neighbor. Its smallest entry is subtracted from it and returned.
  double send(std::size_t node, int direction, const std::vector<double>& belief) {
    const int other = field_.neighbor[node][direction];
    const double part = share(node);
    std::vector<double> out(labels_, std::numeric_limits<double>::max());
    for (int i = 0; i < labels_; ++i) {
      const double own = part * belief[i] - message(node, direction)[i];
      for (int j = 0; j < labels_; ++j) out[j] = std::min(out[j], own + cost(node, direction, i, j));
    }
    const double smallest = *std::min_element(out.begin(), out.end());
    for (int j = 0; j < labels_; ++j) message(other, direction ^ 2)[j] = out[j] - smallest;
    return smallest;
  }

  /// Sends messages in raster order, and selects the cheapest label of each node given those selected before.
  void pass_forward() {
    for (std::size_t node = 0; node < field_.nodes(); ++node) {
      std::vector<double> given(field_.data_of(node), field_.data_of(node) + labels_);
      for (int d = 0; d < 4; ++d) {
        const int other = field_.neighbor[node][d];
        if (other < 0) continue;
        for (int i = 0; i < labels_; ++i)
          given[i] += d < kFirstAhead ? cost(node, d, i, selected_[other]) : message(node, d)[i];
      }
      selected_[node] = static_cast<int>(std::min_element(given.begin(), given.end()) - given.begin());
      const std::vector<double> all = compute_belief(node);
      for (int d = kFirstAhead; d < 4; ++d)
        if (field_.neighbor[node][d] >= 0) send(node, d, all);
    }
  }

  /// Sends messages in the opposite order. Returns the bound: the sum of all that is subtracted from messages and beliefs.
  double pass_backward() {
    double sum = 0;
    for (std::size_t node = field_.nodes(); node-- > 0;) {
      std::vector<double> all = compute_belief(node);
      const double smallest = *std::min_element(all.begin(), all.end());
      for (double& value : all) value -= smallest;
      sum += smallest;
      for (int d = 0; d < kFirstAhead; ++d)
        if (field_.neighbor[node][d] >= 0) sum += send(node, d, all);
    }
    return sum;
  }

  const ShiftField& field_;
  int labels_;
  std::vector<double> incoming_;
  std::vector<int> selected_, best_;
  double energy_ = 0, bound_ = 0;
};

}  // namespace dvi::regularize
