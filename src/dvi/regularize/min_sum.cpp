#include "dvi/regularize/min_sum.h"

#include <cstdint>
#include <cstring>
#include <limits>

// One clone per processor generation, selected when the program starts. Sanitizers run before that selection.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define DVI_TARGET_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define DVI_TARGET_CLONES
#endif

namespace dvi::regularize {

namespace {

// A vector type is used because GCC 12 does not vectorize the loop over lanes. Signs replace comparisons, because GCC computes
// those lane by lane if the registers are shorter. No part may be moved to another function, which would not be cloned.
using Lanes [[gnu::vector_size(kLanes * sizeof(std::int16_t))]] = std::int16_t;

}  // namespace

DVI_TARGET_CLONES
void compute_message(const std::int16_t* belief, const EdgeColors& edge, LabelCounts counts, std::int16_t* out) {
  const auto [labels, stride] = counts;
  int first = 0;
  for (int i = 1; i < labels; ++i)
    if (belief[i] < belief[first]) first = i;
  for (int block = 0; block < stride; block += kLanes) {
    Lanes receiver[6];
    std::int16_t lanes[kLanes];
    for (int c = 0; c < 6; ++c) {
      for (int j = 0; j < kLanes; ++j) lanes[j] = edge.receiver[c / 3][(c % 3) * stride + block + j];
      std::memcpy(&receiver[c], lanes, sizeof lanes);
    }
    Lanes best = Lanes{} + std::numeric_limits<std::int16_t>::max();
    // Costs are not negative. So after the label with the smallest belief, labels with beliefs above all results have no
    // effect.
    std::int16_t bound = std::numeric_limits<std::int16_t>::max();
    for (int k = -1; k < labels; ++k) {
      const int i = k < 0 ? first : k;
      if (belief[i] >= bound) continue;
      Lanes cost = Lanes{} + belief[i];
      for (int c = 0; c < 6; ++c) {
        const Lanes difference = receiver[c] - edge.sender[c / 3][(c % 3) * stride + i], sign = difference >> 15;
        cost += (difference ^ sign) - sign;
      }
      const Lanes less = cost - best;
      best += less & (less >> 15);
      if (k >= 0) continue;
      std::memcpy(lanes, &best, sizeof lanes);
      bound = lanes[0];
      for (int j = 1; j < kLanes; ++j) bound = lanes[j] > bound ? lanes[j] : bound;
    }
    std::memcpy(out + block, &best, sizeof best);
  }
  std::int16_t least = out[0];
  for (int j = 1; j < labels; ++j) least = out[j] < least ? out[j] : least;
  for (int j = 0; j < stride; ++j) out[j] = j < labels ? static_cast<std::int16_t>(out[j] - least) : std::int16_t{0};
}

}  // namespace dvi::regularize
