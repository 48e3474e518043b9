#include "dvi/metrics/bootstrap.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/core/random.h"
#include "dvi/metrics/evaluation.h"
#include "dvi/metrics/tally.h"

namespace dvi::metrics {
namespace {

constexpr std::size_t kResamples = 1000;

std::vector<Figures> resample_figures(const std::vector<OriginSums>& frames) {
  Random random(1);
  std::vector<Figures> out(kResamples);
  for (Figures& resample : out) {
    OriginSums sums;
    for (std::size_t i = 0; i < frames.size(); ++i)
      sums += frames[static_cast<std::size_t>(random.below(static_cast<int>(frames.size())))];
    resample = compute_figures(sums);
  }
  return out;
}

/// Interpolates linearly between two neighbors, as numpy.percentile does.
double compute_quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const double high = sorted[std::min(below + 1, sorted.size() - 1)];
  return sorted[below] + (at - static_cast<double>(below)) * (high - sorted[below]);
}

Interval compute_interval(const std::vector<Figures>& resamples, double Figures::* figure) {
  std::vector<double> values;
  for (const Figures& resample : resamples) values.push_back(resample.*figure);
  if (std::any_of(values.begin(), values.end(), [](double value) { return std::isnan(value); }))
    return {Figures::kNone, Figures::kNone};
  std::sort(values.begin(), values.end());
  return {compute_quantile(values, 0.025), compute_quantile(values, 0.975)};
}

}  // namespace

std::optional<Intervals> estimate_intervals(const std::vector<OriginSums>& frames) {
  if (frames.size() < 2) return std::nullopt;
  const std::vector<Figures> resamples = resample_figures(frames);
  return Intervals{compute_interval(resamples, &Figures::mae), compute_interval(resamples, &Figures::rmse),
                   compute_interval(resamples, &Figures::psnr), compute_interval(resamples, &Figures::ssim),
                   compute_interval(resamples, &Figures::sharpness)};
}

}  // namespace dvi::metrics
