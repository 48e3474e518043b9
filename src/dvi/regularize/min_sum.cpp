#include "dvi/regularize/min_sum.h"

#include <cstdint>
#include <cstring>
#include <limits>

// One clone a processor generation, chosen when the program starts. Sanitizers run before that choice can be made.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define DVI_TARGET_CLONES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define DVI_TARGET_CLONES
#endif

namespace dvi::regularize {

namespace {

// A vector type, for GCC 12 does not vectorize the loop over lanes. Signs in place of comparisons, for it takes those apart
// lane by lane where the processor's registers are shorter. Nothing may be outlined: it would lose the clone's target.
using Lanes [[gnu::vector_size(kLanes * sizeof(std::int16_t))]] = std::int16_t;

}  // namespace

DVI_TARGET_CLONES
void min_sum(const std::int16_t* belief, const EdgeColors& edge, int labels, int stride, std::int16_t* out) {
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
    // Costs are not negative: once the best label has spoken, a label whose belief is above all its answers is silent.
    std::int16_t bound = std::numeric_limits<std::int16_t>::max();
    for (int k = -1; k < labels; ++k) {
      const int i = k < 0 ? first : k;
      if (belief[i] >= bound) continue;
      Lanes cost = Lanes{} + belief[i];
      for (int c = 0; c < 6; ++c) {
        const Lanes apart = receiver[c] - edge.sender[c / 3][(c % 3) * stride + i], sign = apart >> 15;
        cost += (apart ^ sign) - sign;
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
