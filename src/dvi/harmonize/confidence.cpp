#include "dvi/harmonize/confidence.h"

#include <cmath>

namespace dvi::harmonize {

double copied_confidence(const CopyEvidence& evidence) {
  // Fitted by maximum likelihood on synthetic streets, with and without errors in their poses (docs/algorithms/harmonize.md).
  constexpr double kNoise = 2.5, kShift = 1.3, kSpread = 2.8, kAlone = 1, kChange = 2, kPerSecond = 1, kElsewhere = 13;
  constexpr double kEven = 28.6, kSteep = 2.27;  // the expected error at which it is even, and how fast it falls there
  // What the solution changes is another light, seldom an error, where that was to be expected.
  const double light = evidence.elsewhere ? kElsewhere : std::hypot(kChange * evidence.change, kPerSecond * evidence.seconds);
  const double parts[] = {kNoise, kShift * evidence.shift * evidence.texture,
                          kSpread * (evidence.alone ? kAlone : evidence.spread), light};
  double square = 0;
  for (const double part : parts) square += part * part;
  return 1 / (1 + std::pow(std::sqrt(square) / kEven, kSteep));
}

double interpolated_confidence(double distance) { return 0.02 + 0.4 * std::exp(-distance / 8); }

}  // namespace dvi::harmonize
