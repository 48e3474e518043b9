#pragma once

#include <utility>
#include <vector>

#include "dvi/core/median.h"

namespace dvi {

/// The factor from the median absolute deviation to the standard deviation of a normal distribution.
inline constexpr double kSigmaPerMad = 1.4826;

/// Estimates a standard deviation robustly, from the median of the absolute deviations from the center.
template <class T>
double estimate_sigma(std::vector<T> absolute_deviations) {
  return kSigmaPerMad * median(std::move(absolute_deviations));
}

}  // namespace dvi
