#include "dvi/exposure/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "dvi/core/lazy.h"
#include "dvi/core/median.h"
#include "dvi/core/threads.h"
#include "dvi/drive/near_views.h"
#include "dvi/exposure/estimate_vignetting.h"
#include "dvi/exposure/sightings.h"
#include "dvi/geometry/normal_equations.h"
#include "dvi/map/visible_points.h"

namespace dvi::exposure {
namespace {

// Views that are compared: neighbors in time, and some farther apart that keep the chain from drifting.
constexpr std::array<std::size_t, 5> kApart{1, 2, 4, 8, 16};
constexpr std::size_t kPlaces = 3;   // views of earlier sequences, nearest in place, that one of another is compared with
constexpr double kRadian = 10;       // meters that count as much as a radian between directions
constexpr std::size_t kFewest = 50;  // points
constexpr double kFloor = 0.005;     // of a ratio's logarithm: what no number of points makes surer
constexpr double kOutlier = 0.03;    // of a ratio's logarithm: from here on a pair counts less
constexpr double kWeakest = 1e-6;    // the weight of "gain 1" against that of a sure pair; fixes what no pair tells
constexpr int kRounds = 10;          // of reweighting
constexpr double kLargest = 1.3863;  // of a gain's logarithm: 1/4 .. 4

/// How two views' logarithms of gain differ, as the points they share say.
struct Pair {
  std::size_t a = 0, b = 0;
  std::array<double, 3> ratio{};   ///< of b's colors to a's, so gain a - gain b
  std::array<double, 3> weight{};  ///< 1 / variance
};

/// Appends the pair if the views share enough points.
void compare(std::size_t a, std::size_t b, const Lazy<Sightings>& seen, const std::vector<float>& vignetting,
             std::vector<Pair>& out) {
  const std::shared_ptr<const Sightings> in_a = seen[a], in_b = seen[b];
  std::array<std::vector<float>, 3> ratios;
  for_each_shared(*in_a, *in_b, [&](const PointObservation& i, const PointObservation& j) {
    const float darker = vignetting[b] * j.off_axis - vignetting[a] * i.off_axis;
    for (int c = 0; c < 3; ++c) ratios[c].push_back(j.color[c] - i.color[c] + darker);
  });
  if (ratios[0].size() < kFewest) return;
  Pair pair{a, b, {}, {}};
  for (int c = 0; c < 3; ++c) {
    pair.ratio[c] = median(ratios[c]);
    for (float& r : ratios[c]) r = static_cast<float>(std::abs(r - pair.ratio[c]));
    const double sigma = 1.4826 * median(ratios[c]);
    pair.weight[c] = 1 / (kFloor * kFloor + sigma * sigma / static_cast<double>(ratios[c].size()));
  }
  out.push_back(pair);
}

/// The views of earlier sequences that look from nearest to where a view does, by place and direction.
std::vector<std::size_t> places(const Views& views, std::size_t view) {
  return find_nearest_views(views, view, {0, views.of_sequence(views[view].sequence).first}, kPlaces, kRadian);
}

std::vector<Pair> compare_all(const Views& views, const Lazy<Sightings>& seen, const std::vector<float>& vignetting,
                              const Tick& tick) {
  std::vector<std::vector<Pair>> of_view(views.size());
  parallel_in_order(views.size(), [&](std::size_t i) {
    if (!shares_colors(views[i], views[0])) return tick();
    for (const std::size_t apart : kApart)
      if (apart <= i && views[i - apart].sequence == views[i].sequence) compare(i - apart, i, seen, vignetting, of_view[i]);
    for (const std::size_t other : places(views, i))
      if (shares_colors(views[other], views[i])) compare(other, i, seen, vignetting, of_view[i]);
    tick();
  });
  std::vector<Pair> pairs;
  for (const auto& some : of_view) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

/// min over g of sum w rho(g_a - g_b - ratio) + weakest sum g^2, one channel; rho is Cauchy's.
Eigen::VectorXd solve(const std::vector<Pair>& pairs, std::size_t views, int channel) {
  const auto n = static_cast<Eigen::Index>(views);
  Eigen::VectorXd gain = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(i, i, kWeakest / (kFloor * kFloor));
    for (const Pair& p : pairs) {
      const auto a = static_cast<Eigen::Index>(p.a), b = static_cast<Eigen::Index>(p.b);
      const double off = round == 0 ? 0 : (gain[a] - gain[b] - p.ratio[channel]) / kOutlier;
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
  const Lazy<Sightings> seen(
      views.size(), [&](std::size_t i) { return sightings(views[i], *map.points[i], *views.images[i], *views.masks[i]); });
  gains.vignetting = estimate_vignetting(views, seen);
  const std::vector<Pair> pairs = compare_all(views, seen, gains.vignetting, tick);
  for (const Pair& p : pairs) {
    ++gains.compared[p.a];
    ++gains.compared[p.b];
  }
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd gain = solve(pairs, views.size(), c);
    for (std::size_t i = 0; i < views.size(); ++i)
      gains.of_view[i][c] = static_cast<float>(std::exp(std::clamp(gain[static_cast<Eigen::Index>(i)], -kLargest, kLargest)));
  }
  return gains;
}

}  // namespace dvi::exposure
