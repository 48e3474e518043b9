#include "dvi/exposure/estimate_vignetting.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "dvi/core/median.h"
#include "dvi/core/threads.h"

namespace dvi::exposure {
namespace {

/// A point in two views, relative to the median of all points of the two views.
struct Ratio {
  float off_axis = 0;  ///< difference of the distance from the axis, first minus second view
  float brighter = 0;  ///< logarithm of the ratio of brightness, second over first view
};

std::vector<Ratio> compute_ratios(const PointObservations& a, const PointObservations& b) {
  std::vector<Ratio> all;
  for_each_shared(a, b, [&](const PointObservation& i, const PointObservation& j) {
    const cv::Vec3f brighter = j.color - i.color;
    all.push_back({i.off_axis - j.off_axis, (brighter[0] + brighter[1] + brighter[2]) / 3});
  });
  if (all.size() < kVignetting.min_points) return {};
  std::vector<Ratio> out;
  for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / kVignetting.max_points) out.push_back(all[i]);
  for (float Ratio::* value : {&Ratio::off_axis, &Ratio::brighter}) {
    std::vector<float> values;
    for (const Ratio& r : out) values.push_back(r.*value);
    const float middle = median(std::move(values));
    for (Ratio& r : out) r.*value -= middle;
  }
  return out;
}

/// The Cauchy weight of the residual of a ratio for strength k.
float compute_weight(const Ratio& r, float k) {
  const float off = (r.brighter - k * r.off_axis) / kVignetting.outlier;
  return 1 / (1 + off * off);
}

float fit_strength(const std::vector<Ratio>& ratios) {
  float k = 0;
  for (int round = 0; round < kVignetting.iterations; ++round) {
    double product = 0, square = 1e-9;
    for (const Ratio& r : ratios) {
      const double w = compute_weight(r, k);
      product += w * r.off_axis * r.brighter;
      square += w * r.off_axis * r.off_axis;
    }
    k = static_cast<float>(product / square);
  }
  return k;
}

double compute_cost(const std::vector<Ratio>& ratios, float k) {
  double sum = 0;
  for (const Ratio& r : ratios) sum -= std::log(compute_weight(r, k));
  return sum;
}

float estimate_strength(std::size_t first, std::size_t last, const Lazy<PointObservations>& observed) {
  std::vector<std::size_t> views;
  const std::size_t step = std::max<std::size_t>(1, (last - first) / kVignetting.pairs);
  for (std::size_t i = first; i + kVignetting.view_distance < last; i += step) views.push_back(i);
  std::vector<Ratio> even, odd;
  make_and_use(
      views.size(),
      [&](std::size_t n) { return compute_ratios(*observed[views[n]], *observed[views[n] + kVignetting.view_distance]); },
      [&](std::size_t n, const std::vector<Ratio>& ratios) {
        std::vector<Ratio>& half = n % 2 == 0 ? even : odd;
        half.insert(half.end(), ratios.begin(), ratios.end());
      });
  const bool is_confirmed = compute_cost(odd, fit_strength(even)) < compute_cost(odd, 0) &&
                            compute_cost(even, fit_strength(odd)) < compute_cost(even, 0);
  even.insert(even.end(), odd.begin(), odd.end());
  const float k = fit_strength(even);
  return is_confirmed && k >= kVignetting.min_strength ? std::min(k, kVignetting.max_strength) : 0;
}

}  // namespace

std::vector<float> estimate_vignetting(const Views& views, const Lazy<PointObservations>& observed) {
  std::vector<float> out(views.size());
  for (int sequence = 0; sequence < views.sequences(); ++sequence) {
    const auto [first, last] = views.of_sequence(sequence);
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(first), out.begin() + static_cast<std::ptrdiff_t>(last),
              estimate_strength(first, last, observed));
  }
  return out;
}

}  // namespace dvi::exposure
