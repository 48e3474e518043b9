#pragma once

#include <cstdint>

namespace dvi::regularize {

/// Labels are processed in blocks of this many lanes; rows of labels are padded to whole blocks.
inline constexpr int kLanes = 16;

/// The colors of an edge of the MRF. The cost of the sender's label i and the receiver's label j is the L1 distance of the
/// colors (sender[0](i), sender[1](i)) to (receiver[0](j), receiver[1](j)). Each pointer refers to three rows of labels, one
/// per channel.
struct EdgeColors {
  const std::uint8_t* sender[2];
  const std::uint8_t* receiver[2];
};

/// The number of labels, and of entries of a row of labels: a multiple of kLanes.
struct LabelCounts {
  int labels, stride;
};

/// Computes the message out(j) = min_i(belief(i) + cost(i, j)), minus its smallest entry. `belief` and `out` have `stride`
/// entries, of which `labels` are used; 0 <= belief < 16384. Integers make the result the same on every processor.
void compute_message(const std::int16_t* belief, const EdgeColors& edge, LabelCounts counts, std::int16_t* out);

}  // namespace dvi::regularize
