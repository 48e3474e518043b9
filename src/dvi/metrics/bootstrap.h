#pragma once

#include <optional>
#include <vector>

#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/tally.h"

namespace dvi::metrics {

/// 95 % confidence intervals of figures() by the percentile bootstrap (Efron, 1979): 1000 times as many frames as there are
/// are drawn with replacement. Always the same draws. None for fewer than two frames, for one cannot vary.
std::optional<Intervals> bootstrap(const std::vector<OriginSums>& frames);

}  // namespace dvi::metrics
