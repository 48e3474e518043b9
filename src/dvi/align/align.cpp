#include "dvi/align/align.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/SparseCholesky>

#include "dvi/align/pair_search.h"
#include "dvi/core/threads.h"

namespace dvi {
namespace {

// Frames that are compared: neighbours, and some farther apart that keep the chain from drifting.
constexpr std::array<std::size_t, 4> kApart{1, 2, 4, 8};
// The weight of "the calibration is right" against the mean weight of a pair. It fixes the rotation common to all frames, and
// keeps a systematic error of the positions, which from frame to frame looks like a turn, from adding up along the chain;
// jitter from frame to frame, which eight pairs hold against it, is left free (4 %).
constexpr double kPrior = 0.3;

struct Pair {
  std::size_t moving, fixed;
  Comparison::Match match;
};

std::vector<Pair> match_all(const Comparison& comparison, std::size_t first, std::size_t last,
                            const std::vector<Eigen::Vector2d>& corrections, const Tick& tick) {
  std::vector<std::vector<Pair>> by_view(last - first);
  parallel_in_order(last - first, [&](std::size_t i) {
    const std::size_t view = first + i;
    for (const std::size_t apart : kApart)
      for (const int side : {-1, 1}) {
        if ((side < 0 && view < first + apart) || (side > 0 && view + apart >= last)) continue;
        const std::size_t other = side < 0 ? view - apart : view + apart;
        if (const auto match = comparison.match(view, other, corrections)) by_view[i].push_back({view, other, *match});
      }
    tick();
  });
  std::vector<Pair> pairs;
  for (const auto& some : by_view) pairs.insert(pairs.end(), some.begin(), some.end());
  return pairs;
}

// min over u of sum w (u_moving - u_fixed - angle)^2 + prior sum (correction + u)^2, one axis.
Eigen::VectorXd solve_jointly(const std::vector<Pair>& pairs, std::size_t first, std::size_t last,
                              const std::vector<Eigen::Vector2d>& corrections, int axis) {
  const int n = static_cast<int>(last - first);
  double total = 0;
  for (const Pair& p : pairs) total += p.match.weight[axis];
  const double prior = kPrior * total / std::max<double>(1, static_cast<double>(pairs.size())) + 1e-12;
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, prior);
    right[i] -= prior * corrections[first + i][axis];
  }
  for (const Pair& p : pairs) {
    const double w = p.match.weight[axis], d = p.match.angle[axis];
    const int a = static_cast<int>(p.moving - first), b = static_cast<int>(p.fixed - first);
    entries.emplace_back(a, a, w);
    entries.emplace_back(b, b, w);
    entries.emplace_back(a, b, -w);
    entries.emplace_back(b, a, -w);
    right[a] += w * d;
    right[b] -= w * d;
  }
  Eigen::SparseMatrix<double> normal(n, n);
  normal.setFromTriplets(entries.begin(), entries.end());
  return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(normal).solve(right);
}

// Eq. 1 of each view against its neighbours, mean over points.
std::vector<Comparison::Match> energies(const Comparison& comparison, std::size_t first, std::size_t last,
                                        const std::vector<Eigen::Vector2d>& corrections) {
  std::vector<Comparison::Match> out(last - first);
  parallel_in_order(last - first, [&](std::size_t i) {
    const std::size_t view = first + i;
    double sum = 0;
    for (const std::size_t other : {view - 1, view + 1}) {
      if (other < first || other >= last) continue;  // view - 1 of view 0 wraps to the far end
      const auto e = comparison.energy(view, other, corrections);
      if (!e) continue;
      sum += e->energy * e->points;
      out[i].points += e->points;
    }
    out[i].energy = out[i].points > 0 ? sum / out[i].points : 0;
  });
  return out;
}

double sum(const std::vector<Comparison::Match>& energies) {
  double total = 0, points = 0;
  for (const auto& e : energies) {
    total += e.energy * e.points;
    points += e.points;
  }
  return points > 0 ? total / points : 0;
}

void align_drive(Views& views, const StaticMap& map, std::size_t first, std::size_t last, const AlignOptions& options,
                 const Tick& tick, std::vector<ViewAlignment>& result) {
  const Comparison comparison(views, map, options);
  std::vector<Eigen::Vector2d> corrections(views.size(), Eigen::Vector2d::Zero());
  const auto before = energies(comparison, first, last, corrections);
  const double limit = options.max_angle_deg * std::numbers::pi / 180;
  for (int pass = 0; pass < options.passes; ++pass) {
    const std::vector<Pair> pairs = match_all(comparison, first, last, corrections, tick);
    const Eigen::VectorXd pitch = solve_jointly(pairs, first, last, corrections, 0);
    const Eigen::VectorXd yaw = solve_jointly(pairs, first, last, corrections, 1);
    for (std::size_t i = first; i < last; ++i) {
      const Eigen::Vector2d c = corrections[i] + Eigen::Vector2d(pitch[i - first], yaw[i - first]);
      corrections[i] = c.cwiseMax(-limit).cwiseMin(limit);
    }
  }
  auto after = energies(comparison, first, last, corrections);
  const bool better = sum(after) < sum(before);
  if (!better) after = before;
  for (std::size_t i = first; i < last; ++i) {
    const Eigen::Vector2d c = better ? corrections[i] : Eigen::Vector2d::Zero();
    result[i] = {c.x(), c.y(), before[i - first].energy, after[i - first].energy, after[i - first].points};
    views.views[i].camera_from_world = SE3{pitch_yaw(c.x(), c.y()), {0, 0, 0}} * views[i].camera_from_world;
  }
}

}  // namespace

std::vector<ViewAlignment> align(Views& views, const StaticMap& map, const AlignOptions& options, const Tick& tick) {
  std::vector<ViewAlignment> result(views.size());
  if (!options.enabled) return result;
  for (int drive = 0;; ++drive) {
    const auto [first, last] = views.of_drive(drive);
    if (first == last) return result;
    align_drive(views, map, first, last, options, tick, result);
  }
}

}  // namespace dvi
