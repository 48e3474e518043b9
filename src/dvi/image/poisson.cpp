#include "dvi/image/poisson.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace dvi {
namespace {

using Color = Eigen::Array4f;  // the fourth component is unused
using Field = std::vector<Color>;
using Sums = Eigen::Array4d;

bool is_red(cv::Point p) { return (p.x + p.y) % 2 == 0; }

/// A grid equation: diagonal x - sum of weight x over the neighbors = right. Neighbors have different colors in the
/// red-black ordering, so all nodes of a color can be relaxed at once. Fields have an additional last entry of 0 for missing
/// neighbors. `Uniform` levels have no weights: these are 1 and `vertical`.
struct Level {
  float vertical = 1;               // approximate ratio of vertical to horizontal weights
  std::vector<cv::Point> position;  // red nodes first
  int reds = 0;
  std::vector<std::array<int, 4>> neighbor;
  std::vector<std::array<float, 4>> weight;  // none if uniform
  std::vector<float> diagonal, inverse;
  std::vector<int> parent;  // the node of the next level that contains it
  Field x, right;

  int size() const { return static_cast<int>(position.size()); }

  void place(std::vector<cv::Point> nodes) {
    reds = static_cast<int>(std::stable_partition(nodes.begin(), nodes.end(), is_red) - nodes.begin());
    position = std::move(nodes);
    const int none = size();
    neighbor.assign(position.size(), {none, none, none, none});
    diagonal.assign(position.size(), 0);
    x.assign(position.size() + 1, Color::Zero());
    right.assign(position.size() + 1, Color::Zero());
  }
  void finish() {
    inverse.reserve(diagonal.size());
    for (const float d : diagonal) inverse.push_back(d > 0 ? 1 / d : 0);
  }
  /// Returns the weighted sum of the neighbors.
  template <bool Uniform>
  Color pull(int i, const Field& of) const {
    const auto& [a, b, c, d] = neighbor[i];
    if constexpr (Uniform) return of[a] + of[c] + vertical * (of[b] + of[d]);
    const auto& [wa, wb, wc, wd] = weight[i];
    return wa * of[a] + wb * of[b] + wc * of[c] + wd * of[d];
  }
  template <bool Uniform>
  void relax(int first, int last) {
    for (int i = first; i < last; ++i) x[i] = (right[i] + pull<Uniform>(i, x)) * inverse[i];
  }
};

cv::Mat1i number_nodes(const std::vector<cv::Point>& nodes) {
  cv::Point last;
  for (const cv::Point p : nodes) last = {std::max(last.x, p.x), std::max(last.y, p.y)};
  cv::Mat1i out(last.y + 1, last.x + 1, -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) out(nodes[i]) = static_cast<int>(i);
  return out;
}

void set_weights(Level& level, const PoissonSystem& system) {
  const auto number = [&](int node) { return system.region.index(level.position[node]); };
  const auto beside = [&](int node) { return system.beside.empty() ? 1 : system.beside[number(node)]; };
  const auto below = [&](int node) { return system.below.empty() ? system.vertical : system.below[number(node)]; };
  level.weight.assign(level.position.size(), {});
  for (int i = 0; i < level.size(); ++i) {
    const auto [left, above, right, under] = level.neighbor[i];
    if (left < level.size()) level.weight[i][0] = beside(left);
    if (above < level.size()) level.weight[i][1] = below(above);
    level.weight[i][2] = beside(i);
    level.weight[i][3] = below(i);
  }
}

Level make_finest_level(const PoissonSystem& system) {
  Level level;
  level.vertical = system.vertical;
  level.place(system.region.pixels);
  const cv::Mat1i number = number_nodes(level.position);
  const cv::Point step[4] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};
  const cv::Rect inside({}, number.size());
  for (int i = 0; i < level.size(); ++i) {
    level.diagonal[i] = system.diagonal[system.region.index(level.position[i])];
    for (int d = 0; d < 4; ++d) {
      const cv::Point q = level.position[i] + step[d];
      if (inside.contains(q) && number(q) >= 0) level.neighbor[i][d] = number(q);
    }
  }
  if (!system.beside.empty() || !system.below.empty()) set_weights(level, system);
  level.finish();
  return level;
}

/// Creates the nodes of the next level from blocks of 2 x 2, or 2 x 1 if vertical weights are larger.
Level make_blocks(Level& fine, cv::Point block) {
  std::vector<cv::Point> at;
  for (const cv::Point p : fine.position) at.emplace_back(p.x / block.x, p.y / block.y);
  cv::Mat1i number = number_nodes(at);
  std::vector<cv::Point> nodes;  // each block once, at its last pixel
  for (std::size_t i = 0; i < at.size(); ++i)
    if (number(at[i]) == static_cast<int>(i)) nodes.push_back(at[i]);
  Level level;
  level.place(std::move(nodes));
  number = number_nodes(level.position);
  for (const cv::Point p : at) fine.parent.push_back(number(p));
  fine.parent.push_back(level.size());
  return level;
}

/// Sums over piecewise constants make the edges of a coarser grid twice too stiff along the coarsened direction (Braess 1995),
/// hence the factor 1/2.
Level make_coarser_level(Level& fine) {
  constexpr float kIsotropic = 0.5F;
  constexpr float kBoundary = 2.0F / 3;  // the boundary is one and a half pixels from the center of a block, the next block two
  const bool along_rows = fine.vertical < kIsotropic;
  const float across = along_rows ? 1 : 0.5F;
  const float stiff[4] = {0.5F, across, 0.5F, across};
  Level level = make_blocks(fine, {2, along_rows ? 1 : 2});
  level.vertical = along_rows ? 4 * fine.vertical : fine.vertical;
  level.weight.assign(level.position.size(), {});
  const std::array<float, 4> uniform{1, fine.vertical, 1, fine.vertical};
  for (int i = 0; i < fine.size(); ++i) {
    const int parent = fine.parent[i];
    const std::array<float, 4>& weight = fine.weight.empty() ? uniform : fine.weight[i];
    float held = fine.diagonal[i];  // the weight of neighbors outside the region
    for (int d = 0; d < 4; ++d) {
      if (fine.neighbor[i][d] == fine.size()) continue;
      held -= weight[d];
      const int other = fine.parent[fine.neighbor[i][d]];
      if (other == parent) continue;
      level.neighbor[parent][d] = other;
      level.weight[parent][d] += stiff[d] * weight[d];
      level.diagonal[parent] += stiff[d] * weight[d];
    }
    level.diagonal[parent] += kBoundary * std::max(held, 0.0F);
  }
  level.finish();
  return level;
}

class Multigrid {
 public:
  explicit Multigrid(const PoissonSystem& system) {
    levels_.push_back(make_finest_level(system));
    while (levels_.back().size() > kMaxCoarsestSize) {
      Level next = make_coarser_level(levels_.back());
      levels_.push_back(std::move(next));
    }
  }

  const Level& finest() const { return levels_.front(); }

  /// Returns an approximation of A^-1 `right` by one symmetric cycle.
  const Field& precondition(Field& right) {
    levels_[0].right.swap(right);
    if (levels_[0].weight.empty())
      cycle<true>(0);
    else
      cycle<false>(0);
    levels_[0].right.swap(right);
    return levels_[0].x;
  }

 private:
  static constexpr int kMaxCoarsestSize = 16;

  template <bool Uniform>
  void cycle(std::size_t depth) {
    Level& level = levels_[depth];
    const int reds = level.reds, all = level.size();
    for (int i = 0; i < reds; ++i) level.x[i] = level.right[i] * level.inverse[i];
    level.relax<Uniform>(reds, all);
    if (depth + 1 == levels_.size()) {
      for (int sweep = 0; sweep < 10; ++sweep) {
        level.relax<Uniform>(0, reds);
        level.relax<Uniform>(reds, all);
      }
      for (int sweep = 0; sweep < 10; ++sweep) {
        level.relax<Uniform>(reds, all);
        level.relax<Uniform>(0, reds);
      }
    } else {
      Level& below = levels_[depth + 1];
      std::fill(below.right.begin(), below.right.end(), Color::Zero());
      for (int i = 0; i < reds; ++i)  // black nodes are already solved
        below.right[level.parent[i]] += level.right[i] + level.pull<Uniform>(i, level.x) - level.diagonal[i] * level.x[i];
      cycle<false>(depth + 1);
      for (int i = 0; i < all; ++i) level.x[i] += below.x[level.parent[i]];
    }
    level.relax<Uniform>(reds, all);
    level.relax<Uniform>(0, reds);
  }

  std::vector<Level> levels_;
};

Color divide(const Sums& a, const Sums& b) { return (b > 0).select(a / b, Sums::Zero()).cast<float>(); }

Color to_color(const cv::Vec3f& c) { return {c[0], c[1], c[2], 0}; }

}  // namespace

int solve_poisson(const PoissonSystem& system, std::vector<cv::Vec3f>& x, double tolerance) {
  constexpr int kMaxIterations = 200;
  if (system.region.size() == 0) return 0;
  Multigrid multigrid(system);
  const Level& a = multigrid.finest();
  const int n = a.size();
  const auto pull = [&](int i, const Field& of) { return a.weight.empty() ? a.pull<true>(i, of) : a.pull<false>(i, of); };
  const Field none(a.x.size(), Color::Zero());
  Field solution = none, residual = none, direction = none, image = none;
  for (int i = 0; i < n; ++i) solution[i] = to_color(x[system.region.index(a.position[i])]);
  for (int i = 0; i < n; ++i)
    residual[i] = to_color(system.right[system.region.index(a.position[i])]) + pull(i, solution) - a.diagonal[i] * solution[i];
  Sums before = Sums::Zero();
  int iteration = 0;
  for (; iteration < kMaxIterations; ++iteration) {
    const Field& error = multigrid.precondition(residual);
    Color largest = Color::Zero();
    Sums now = Sums::Zero(), energy = Sums::Zero();
    for (int i = 0; i < n; ++i) {
      largest = largest.max(error[i].abs());
      now += (residual[i] * error[i]).cast<double>();
    }
    if (largest.maxCoeff() < tolerance) break;
    const Color keep = divide(now, before);
    before = now;
    for (int i = 0; i < n; ++i) direction[i] = error[i] + keep * direction[i];
    for (int i = 0; i < n; ++i) {
      image[i] = a.diagonal[i] * direction[i] - pull(i, direction);
      energy += (direction[i] * image[i]).cast<double>();
    }
    const Color step = divide(now, energy);
    for (int i = 0; i < n; ++i) {
      solution[i] += step * direction[i];
      residual[i] -= step * image[i];
    }
  }
  for (int i = 0; i < n; ++i) {
    const Color& c = solution[i];
    x[system.region.index(a.position[i])] = {c[0], c[1], c[2]};
  }
  return iteration;
}

}  // namespace dvi
