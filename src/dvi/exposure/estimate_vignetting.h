#pragma once

#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/drive/view.h"
#include "dvi/exposure/observe_points.h"

namespace dvi::exposure {

/// Parameters of vignetting.
struct VignettingParams {
  std::size_t min_points = 50;    ///< of a pair of views
  std::size_t max_points = 1000;  ///< of a pair of views, so that no pair dominates
  float outlier = 0.05F;          ///< scale of the robust weight, in logarithms of brightness
  int iterations = 10;            ///< of reweighting
  std::size_t pairs = 24;         ///< of views, evenly spaced along the sequence
  std::size_t view_distance = 4;  ///< views between the two of a pair: points move far enough and still look alike
  float min_strength = 0.04F;     ///< 1 % at half a radian
  float max_strength = 2;         ///< the cos^4 law in linear light
};
inline constexpr VignettingParams kVignetting;

/// Estimates View::vignetting for each view, one value per sequence, robustly, from points that several views show at different
/// distances from the optical axis. Returns 0 if vignetting is not significant: less than 1 % at half a radian, or if the
/// estimates of two halves of the pairs do not confirm each other.
std::vector<float> estimate_vignetting(const Views& views, const Lazy<PointObservations>& observed);

}  // namespace dvi::exposure
