#pragma once

#include <cstdint>

namespace dvi::regularize {

/// Labels come in blocks of this many lanes; rows of labels are padded to whole blocks.
inline constexpr int kLanes = 16;

/// An edge of the MRF as its sender and its receiver see it. Its cost between labels i and j is the L1 distance of
/// (sender[0](i), sender[1](i)) to (receiver[0](j), receiver[1](j)), each entry a color: a row of labels a channel.
struct EdgeColors {
  const std::uint8_t* sender[2];
  const std::uint8_t* receiver[2];
};

/// Min-sum message: out(j) = min_i belief(i) + cost(i, j), less its smallest entry. `belief` and `out` have `stride` entries
/// (whole blocks) of which `labels` count; 0 <= belief < 16384. Integers, so the same on every processor.
void min_sum(const std::int16_t* belief, const EdgeColors& edge, int labels, int stride, std::int16_t* out);

}  // namespace dvi::regularize
