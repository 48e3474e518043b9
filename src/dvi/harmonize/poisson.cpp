#include "dvi/harmonize/poisson.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace dvi::harmonize {
namespace {

using Colour = Eigen::Array4f;  // the fourth lane is idle
using Field = std::vector<Colour>;
using Sums = Eigen::Array4d;

/// A grid equation: diagonal x - sum of weight x over the neighbours = right. Neighbours are of different squares of the
/// checkerboard, so each can be relaxed at once.
struct Level {
  std::vector<cv::Point> position;
  std::vector<std::array<int, 4>> neighbour;  // itself, with weight 0, where there is none
  std::vector<std::array<float, 4>> weight;
  std::vector<float> diagonal, inverse;
  std::vector<int> red, black;
  std::vector<int> parent;  // the node of the next level that it is part of
  Field x, right;

  std::size_t size() const { return position.size(); }

  void add_node(cv::Point at, float diag) {
    const int self = static_cast<int>(size());
    position.push_back(at);
    neighbour.push_back({self, self, self, self});
    weight.push_back({0, 0, 0, 0});
    diagonal.push_back(diag);
  }
  void finish() {
    for (std::size_t i = 0; i < size(); ++i) {
      ((position[i].x + position[i].y) % 2 == 0 ? red : black).push_back(static_cast<int>(i));
      inverse.push_back(diagonal[i] > 0 ? 1 / diagonal[i] : 0);
    }
    x.assign(size(), Colour::Zero());
    right.assign(size(), Colour::Zero());
  }
  Colour pull(int i, const Field& of) const {
    const auto& [a, b, c, d] = neighbour[i];
    const auto& [wa, wb, wc, wd] = weight[i];
    return wa * of[a] + wb * of[b] + wc * of[c] + wd * of[d];
  }
  void relax(const std::vector<int>& nodes) {
    for (const int i : nodes) x[i] = (right[i] + pull(i, x)) * inverse[i];
  }
};

Level finest_level(const PoissonSystem& system) {
  Level level;
  for (std::size_t i = 0; i < system.region.size(); ++i) level.add_node(system.region.pixels[i], system.diagonal[i]);
  const cv::Point step[4] = {{-1, 0}, {0, -1}, {1, 0}, {0, 1}};
  const cv::Rect image({}, system.region.index.size());
  for (std::size_t i = 0; i < level.size(); ++i)
    for (int d = 0; d < 4; ++d) {
      const cv::Point q = level.position[i] + step[d];
      if (!image.contains(q) || system.region.index(q) < 0) continue;
      level.neighbour[i][d] = system.region.index(q);
      level.weight[i][d] = step[d].y == 0 ? 1 : system.vertical;
    }
  level.finish();
  return level;
}

/// The nodes of each block of 2 x 2 as one. Sums over piecewise constants make the edges of a coarser grid twice too stiff
/// (Braess 1995), hence the half.
Level coarser(Level& fine) {
  Level level;
  int columns = 0, rows = 0;
  for (const cv::Point p : fine.position) {
    columns = std::max(columns, p.x / 2 + 1);
    rows = std::max(rows, p.y / 2 + 1);
  }
  cv::Mat1i block(rows, columns, -1);
  fine.parent.resize(fine.size());
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const cv::Point at = fine.position[i] / 2;
    if (block(at) < 0) {
      block(at) = static_cast<int>(level.size());
      level.add_node(at, 0);
    }
    fine.parent[i] = block(at);
  }
  for (std::size_t i = 0; i < fine.size(); ++i) {
    const int parent = fine.parent[i];
    level.diagonal[parent] += 0.5F * fine.diagonal[i];
    for (int d = 0; d < 4; ++d) {
      const int other = fine.parent[fine.neighbour[i][d]];
      const float w = 0.5F * fine.weight[i][d];
      if (other == parent) {
        level.diagonal[parent] -= w;
      } else {
        level.neighbour[parent][d] = other;
        level.weight[parent][d] += w;
      }
    }
  }
  level.finish();
  return level;
}

class Multigrid {
 public:
  explicit Multigrid(const PoissonSystem& system) {
    levels_.push_back(finest_level(system));
    while (levels_.back().size() > kCoarsest) {
      Level next = coarser(levels_.back());
      levels_.push_back(std::move(next));
    }
  }

  const Level& finest() const { return levels_.front(); }

  /// About A^-1 `right`: one symmetric cycle.
  const Field& precondition(const Field& right) {
    levels_[0].right = right;
    cycle(0);
    return levels_[0].x;
  }

 private:
  static constexpr std::size_t kCoarsest = 16;

  void cycle(std::size_t depth) {
    Level& level = levels_[depth];
    for (const int i : level.red) level.x[i] = level.right[i] * level.inverse[i];
    level.relax(level.black);
    if (depth + 1 == levels_.size()) {
      for (int sweep = 0; sweep < 10; ++sweep) {
        level.relax(level.red);
        level.relax(level.black);
      }
      for (int sweep = 0; sweep < 10; ++sweep) {
        level.relax(level.black);
        level.relax(level.red);
      }
    } else {
      Level& below = levels_[depth + 1];
      std::fill(below.right.begin(), below.right.end(), Colour::Zero());
      for (const int i : level.red)  // the black ones have just been solved
        below.right[level.parent[i]] += level.right[i] + level.pull(i, level.x) - level.diagonal[i] * level.x[i];
      cycle(depth + 1);
      for (std::size_t i = 0; i < level.size(); ++i) level.x[i] += below.x[level.parent[i]];
    }
    level.relax(level.black);
    level.relax(level.red);
  }

  std::vector<Level> levels_;
};

Sums dot(const Field& a, const Field& b) {
  Sums sum = Sums::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] * b[i]).cast<double>();
  return sum;
}

Colour ratio(const Sums& a, const Sums& b) { return (b > 0).select(a / b, Sums::Zero()).cast<float>(); }

double largest(const Field& of) {
  Colour most = Colour::Zero();
  for (const Colour& c : of) most = most.max(c.abs());
  return most.maxCoeff();
}

}  // namespace

int solve(const PoissonSystem& system, std::vector<cv::Vec3f>& x, double tolerance) {
  constexpr int kMost = 200;
  const std::size_t n = system.region.size();
  if (n == 0) return 0;
  Multigrid multigrid(system);
  const Level& a = multigrid.finest();
  Field solution(n), residual(n), direction(n), image(n);
  for (std::size_t i = 0; i < n; ++i) solution[i] = {x[i][0], x[i][1], x[i][2], 0};
  for (std::size_t i = 0; i < n; ++i)
    residual[i] = Colour(system.right[i][0], system.right[i][1], system.right[i][2], 0) +
                  a.pull(static_cast<int>(i), solution) - a.diagonal[i] * solution[i];
  Sums before = Sums::Zero();
  int iteration = 0;
  for (; iteration < kMost; ++iteration) {
    const Field& error = multigrid.precondition(residual);
    if (largest(error) < tolerance) break;
    const Sums now = dot(residual, error);
    const Colour keep = ratio(now, before);
    before = now;
    for (std::size_t i = 0; i < n; ++i) direction[i] = iteration == 0 ? error[i] : error[i] + keep * direction[i];
    for (std::size_t i = 0; i < n; ++i) image[i] = a.diagonal[i] * direction[i] - a.pull(static_cast<int>(i), direction);
    const Colour step = ratio(now, dot(direction, image));
    for (std::size_t i = 0; i < n; ++i) {
      solution[i] += step * direction[i];
      residual[i] -= step * image[i];
    }
  }
  for (std::size_t i = 0; i < n; ++i) x[i] = {solution[i][0], solution[i][1], solution[i][2]};
  return iteration;
}

}  // namespace dvi::harmonize
