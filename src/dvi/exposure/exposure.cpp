#include "dvi/exposure/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "dvi/core/lazy.h"
#include "dvi/core/statistics.h"
#include "dvi/core/threads.h"
#include "dvi/drive/near_views.h"
#include "dvi/exposure/estimate_vignetting.h"
#include "dvi/exposure/observe_points.h"
#include "dvi/geometry/normal_equations.h"
#include "dvi/map/visible_points.h"

namespace dvi::exposure {
namespace {

/// Distances in frames of compared views: neighbors, and larger distances that prevent drift.
constexpr std::array<std::size_t, 5> kFrameDistances{1, 2, 4, 8, 16};

/// The difference of the logarithms of the gains of two views, from their shared points.
struct GainRatio {
  std::size_t a = 0, b = 0;
  std::array<double, 3> ratio{};   ///< logarithm of the colors of b over those of a: gain a - gain b
  std::array<double, 3> weight{};  ///< 1 / variance
};

/// The logarithms of the colors of a channel of points in two views.
struct SharedColors {
  std::vector<float> a, b;
};

/// Sets the ratio of a channel and its weight. The ratio is that of the sums of the colors, without outliers: the median of the
/// ratios of single points would be biased, because views from afar blur the texture of a surface, and the logarithm of a mean
/// is larger than the mean of logarithms.
void compute_ratio(const SharedColors& colors, int channel, GainRatio& pair) {
  std::vector<float> ratios(colors.a.size());
  for (std::size_t i = 0; i < ratios.size(); ++i) ratios[i] = colors.b[i] - colors.a[i];
  const float middle = median(ratios);
  std::vector<float> off(ratios.size());
  for (std::size_t i = 0; i < off.size(); ++i) off[i] = std::abs(ratios[i] - middle);
  const auto sigma = static_cast<float>(estimate_sigma(off));
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < ratios.size(); ++i)
    if (std::abs(ratios[i] - middle) <= kExposure.max_sigmas * sigma) {
      sum_a += std::exp(colors.a[i]);
      sum_b += std::exp(colors.b[i]);
    }
  pair.ratio[channel] = std::log(sum_b / sum_a);
  pair.weight[channel] = 1 / (kExposure.min_sigma * kExposure.min_sigma + sigma * sigma / static_cast<double>(ratios.size()));
}

/// Computes the ratio of two views; none if they share too few points.
std::optional<GainRatio> compare_views(std::size_t a, std::size_t b, const Lazy<PointObservations>& observed,
                                       const std::vector<float>& vignetting) {
  const std::shared_ptr<const PointObservations> in_a = observed[a], in_b = observed[b];
  std::array<SharedColors, 3> colors;
  for_each_shared(*in_a, *in_b, [&](const PointObservation& i, const PointObservation& j) {
    for (int c = 0; c < 3; ++c) {
      colors[c].a.push_back(i.color[c] + vignetting[a] * i.off_axis);
      colors[c].b.push_back(j.color[c] + vignetting[b] * j.off_axis);
    }
  });
  if (colors[0].a.size() < kExposure.min_points) return std::nullopt;
  GainRatio pair{a, b, {}, {}};
  for (int c = 0; c < 3; ++c) compute_ratio(colors[c], c, pair);
  return pair;
}

/// Finds the views of earlier sequences with the most similar position and direction.
std::vector<std::size_t> find_anchors(const Views& views, std::size_t view) {
  return find_nearest_views(views, view, {0, views.of_sequence(views[view].sequence).first},
                            {kExposure.anchors, kExposure.radian_m});
}

std::vector<GainRatio> compare_all_views(const Views& views, const Lazy<PointObservations>& observed,
                                         const std::vector<float>& vignetting, const Tick& tick) {
  std::vector<std::vector<GainRatio>> of_view(views.size());
  parallel_in_order(views.size(), [&](std::size_t i) {
    if (!shares_colors(views[i], views[0])) return tick();
    const auto compare = [&](std::size_t other) {
      if (const auto ratio = compare_views(other, i, observed, vignetting)) of_view[i].push_back(*ratio);
    };
    for (const std::size_t distance : kFrameDistances)
      if (distance <= i && views[i - distance].sequence == views[i].sequence) compare(i - distance);
    for (const std::size_t other : find_anchors(views, i))
      if (shares_colors(views[other], views[i])) compare(other);
    tick();
  });
  std::vector<GainRatio> pairs;
  for (const auto& some : of_view) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

/// Minimizes sum w rho(g_a - g_b - ratio) + prior sum g^2 over g for one channel; rho is the Cauchy loss.
Eigen::VectorXd solve_gains(const std::vector<GainRatio>& pairs, std::size_t views, int channel) {
  const auto n = static_cast<Eigen::Index>(views);
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < kExposure.iterations; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i)
      entries.emplace_back(i, i, kExposure.prior_weight / (kExposure.min_sigma * kExposure.min_sigma));
    for (const GainRatio& p : pairs) {
      const auto a = static_cast<Eigen::Index>(p.a), b = static_cast<Eigen::Index>(p.b);
      const double off = round == 0 ? 0 : (gain[a] - gain[b] - p.ratio[channel]) / kExposure.outlier;
      const double w = p.weight[channel] / (1 + off * off);
      entries.emplace_back(a, a, w);
      entries.emplace_back(b, b, w);
      entries.emplace_back(a, b, -w);
      entries.emplace_back(b, a, -w);
      right[a] += w * p.ratio[channel];
      right[b] -= w * p.ratio[channel];
    }
    gain = solve_normal_equations(entries, right);
  }
  return gain;
}

}  // namespace

Gains estimate_exposure(const Views& views, const map::VisibleMap& map, const Tick& tick) {
  Gains gains(views.size());
  const Lazy<PointObservations> observed(
      views.size(), [&](std::size_t i) { return observe_points(views[i], *map.points[i], *views.images[i], *views.masks[i]); });
  gains.vignetting = estimate_vignetting(views, observed);
  const std::vector<GainRatio> pairs = compare_all_views(views, observed, gains.vignetting, tick);
  for (const GainRatio& p : pairs) {
    ++gains.compared[p.a];
    ++gains.compared[p.b];
  }
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd gain = solve_gains(pairs, views.size(), c);
    for (std::size_t i = 0; i < views.size(); ++i)
      gains.of_view[i][c] = static_cast<float>(
          std::exp(std::clamp(gain[static_cast<Eigen::Index>(i)], -kExposure.max_log_gain, kExposure.max_log_gain)));
  }
  return gains;
}

}  // namespace dvi::exposure
