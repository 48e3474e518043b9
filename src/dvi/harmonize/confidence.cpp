#include "dvi/harmonize/confidence.h"

#include <cmath>

namespace dvi {

double copied_confidence(const CopyEvidence& evidence) {
  constexpr double kNoise = 2.5;  // grey levels of the camera
  constexpr double kShift = 0.5, kSpread = 0.5, kChange = 0.5, kLight = 1, kAlone = 8;
  constexpr double kEven = 8, kSteep = 2;
  const double spread = evidence.alone ? kAlone : evidence.spread;
  const double parts[] = {kNoise, kShift * evidence.shift * evidence.texture, kSpread * spread, kChange * evidence.change,
                          kLight * evidence.seconds};
  double square = 0;
  for (const double part : parts) square += part * part;
  return 1 / (1 + std::pow(square / (kEven * kEven), 0.5 * kSteep));
}

double interpolated_confidence(double distance) { return 0.02 + 0.4 * std::exp(-distance / 8); }

}  // namespace dvi
