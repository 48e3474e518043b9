#pragma once

#include "dvi/harmonize/copies.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// A difference between sources and target fades over 1 / sqrt(weight) pixels from the rim. Two days differ there in more than
/// light: shadows, parked cars, the sky. Copies of other days are therefore held everywhere, others with a robust rim only: as
/// far as what they differ by varies along the rim nearby, or sources contradict each other at seams. There they are misplaced,
/// or show what has changed.
Hold hold_of(const Copies& copies, const sample::Candidates& candidates, bool robust_rim);

}  // namespace dvi::harmonize
