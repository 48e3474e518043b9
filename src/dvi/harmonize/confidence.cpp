#include "dvi/harmonize/confidence.h"

#include <cmath>

namespace dvi {

double copied_confidence(const CopyEvidence& evidence) {
  const double light = 1 - 0.3 * evidence.seconds / (evidence.seconds + 10);  // sun and clouds; further drives: 0.7
  const double place = 1 / (1 + 10 * evidence.depth_spread);
  const double seam = 1 / (1 + evidence.change / 40);
  return 0.8 * light * place * seam;
}

double interpolated_confidence(double distance) { return 0.1 + 0.5 * std::exp(-distance / 8); }

}  // namespace dvi
