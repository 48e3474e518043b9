#include "dvi/regularize/belief_propagation.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "dvi/regularize/min_sum.h"
#include "dvi/regularize/shift_field.h"

namespace dvi::regularize {
namespace {

/// Returns the colors of the edge from a node in a direction. Where a source does not show the neighbor, `zeros` is used for
/// both sides, so that the cost is 0.
EdgeColors make_edge(const ShiftField& field, std::size_t node, int direction, const std::uint8_t* zeros) {
  const int other = field.neighbor[node][direction];
  const int forth = field.expected[node][direction], back = field.expected[other][direction ^ 2];
  const std::uint8_t* own = field.row(static_cast<int>(node));
  return {{forth < 0 ? zeros : field.row(forth), back < 0 ? zeros : own},
          {forth < 0 ? zeros : field.row(other), back < 0 ? zeros : field.row(back)}};
}

int compute_edge_cost(const EdgeColors& edge, int stride, int i, int j) {
  int cost = 0;
  for (int c = 0; c < 6; ++c)
    cost += std::abs(edge.sender[c / 3][(c % 3) * stride + i] - edge.receiver[c / 3][(c % 3) * stride + j]);
  return cost;
}

enum class Order : std::uint8_t { forward, backward };

/// The messages between all nodes.
class Messages {
 public:
  explicit Messages(const ShiftField& field)
      : field_(field),
        incoming_(field.nodes() * 4 * field.stride),
        unsent_(field.nodes(), kAhead | kBehind),
        zeros_(std::size_t{3} * field.stride),
        belief_(field.stride),
        without_(field.stride),
        message_(field.stride) {}

  /// In raster order, sends messages from every node with new messages to its right and lower neighbors, or in the opposite
  /// order to its left and upper ones, so that messages cross the whole hole in one sweep. Returns whether any message changed.
  bool sweep(Order order) {
    const bool forward = order == Order::forward;
    bool changed = false;
    const std::size_t nodes = field_.nodes();
    for (std::size_t k = 0; k < nodes; ++k) {
      const std::size_t node = forward ? k : nodes - 1 - k;
      const std::uint8_t mark = forward ? kAhead : kBehind;
      if ((unsent_[node] & mark) == 0) continue;
      unsent_[node] &= static_cast<std::uint8_t>(~mark);
      changed |= send(node, forward ? 2 : 0);
    }
    return changed;
  }

  /// Selects labels in raster order, each the cheapest given those of the left and upper neighbors. Selection by beliefs alone
  /// would mix equally good solutions.
  std::vector<int> select_labels() {
    std::vector<int> out(field_.nodes());
    std::vector<int> cost(field_.labels());
    for (std::size_t node = 0; node < field_.nodes(); ++node) {
      std::copy(field_.data_of(node), field_.data_of(node) + field_.labels(), cost.begin());
      for (int d = 0; d < 4; ++d) {
        const int other = field_.neighbor[node][d];
        if (other < 0) continue;
        const EdgeColors edge = make_edge(field_, node, d, zeros_.data());
        const Cost* in = incoming(node, d);
        for (int i = 0; i < field_.labels(); ++i)
          cost[i] += d < 2 ? compute_edge_cost(edge, field_.stride, i, out[other]) : in[i];
      }
      // The first of equal costs is the shortest shift. A small cost of shifts instead would accumulate around loops.
      out[node] = static_cast<int>(std::min_element(cost.begin(), cost.end()) - cost.begin());
    }
    return out;
  }

 private:
  using Cost = std::int16_t;
  static constexpr std::uint8_t kAhead = 1, kBehind = 2;

  /// The message into a node from its neighbor in a direction.
  Cost* incoming(std::size_t node, int direction) { return &incoming_[(node * 4 + direction) * field_.stride]; }

  void sum_incoming(std::size_t node) {
    const Cost* data = field_.data_of(node);
    std::copy(data, data + field_.stride, belief_.begin());
    for (int d = 0; d < 4; ++d) {
      if (field_.neighbor[node][d] < 0) continue;
      const Cost* in = incoming(node, d);
      for (int i = 0; i < field_.stride; ++i) belief_[i] = static_cast<Cost>(belief_[i] + in[i]);
    }
  }

  bool send(std::size_t node, int first_direction) {
    bool changed = false;
    sum_incoming(node);
    for (int d = first_direction; d < first_direction + 2; ++d) {
      const int other = field_.neighbor[node][d];
      if (other < 0) continue;
      const Cost* in = incoming(node, d);
      for (int i = 0; i < field_.stride; ++i) without_[i] = static_cast<Cost>(belief_[i] - in[i]);
      compute_message(without_.data(), make_edge(field_, node, d, zeros_.data()), {field_.labels(), field_.stride},
                      message_.data());
      Cost* out = incoming(other, d ^ 2);
      if (std::equal(message_.begin(), message_.begin() + field_.labels(), out)) continue;
      std::copy(message_.begin(), message_.end(), out);
      unsent_[other] = kAhead | kBehind;
      changed = true;
    }
    return changed;
  }

  const ShiftField& field_;
  std::vector<Cost> incoming_;
  std::vector<std::uint8_t> unsent_;  // the sides to which each node has to send messages: kAhead, kBehind
  std::vector<std::uint8_t> zeros_;
  std::vector<Cost> belief_, without_, message_;
};

}  // namespace

double compute_energy(const ShiftField& field, const std::vector<int>& labels) {
  const std::vector<std::uint8_t> zeros(std::size_t{3} * field.stride);
  double sum = 0;
  for (std::size_t node = 0; node < field.nodes(); ++node) {
    sum += field.data_of(node)[labels[node]];
    for (const int d : {2, 3}) {
      const int other = field.neighbor[node][d];
      if (other >= 0)
        sum += compute_edge_cost(make_edge(field, node, d, zeros.data()), field.stride, labels[node], labels[other]);
    }
  }
  return sum;
}

BeliefPropagation propagate_beliefs(const ShiftField& field, int iterations) {
  BeliefPropagation out;
  out.labels.assign(field.nodes(), 0);
  out.energy_before = out.energy_after = compute_energy(field, out.labels);
  if (field.labels() == 1) return out;
  Messages messages(field);
  for (bool changed = true; changed && out.iterations < iterations; ++out.iterations) {
    changed = messages.sweep(Order::forward);
    changed |= messages.sweep(Order::backward);
    std::vector<int> labels = messages.select_labels();
    const double energy = compute_energy(field, labels);
    if (energy < out.energy_after) {
      out.energy_after = energy;
      out.labels = std::move(labels);
    }
  }
  return out;
}

}  // namespace dvi::regularize
