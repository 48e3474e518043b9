#pragma once

#include <optional>
#include <vector>

#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/tally.h"

namespace dvi::metrics {

/// Estimates 95 % confidence intervals of figures() by the percentile bootstrap (Efron, 1979), with 1000 resamples of the
/// frames with replacement. The seed is fixed. Returns nothing for fewer than two frames.
std::optional<Intervals> estimate_intervals(const std::vector<OriginSums>& frames);

}  // namespace dvi::metrics
