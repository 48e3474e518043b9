#include "dvi/objects/contradictions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace dvi::objects {
namespace {

using GroundSquare = std::pair<int, int>;

constexpr double kGroundSquareM = 0.5;
constexpr std::size_t kMinJudgedSquares = 30;
constexpr double kMaxUnexplainedShare = 0.06;
constexpr double kMaxContradictoryShare = 1.0 / 3;  // of all scans; beyond, none is trusted

GroundSquare ground_square_of(const Eigen::Vector3d& x) {
  return {static_cast<int>(std::floor(x.x() / kGroundSquareM)), static_cast<int>(std::floor(x.y() / kGroundSquareM))};
}

// The squares of the tracked objects in each scan, and those that touch them.
std::vector<std::set<GroundSquare>> explained_squares(std::size_t scans, const std::vector<Track>& tracks) {
  std::vector<std::set<GroundSquare>> out(scans);
  for (const Track& track : tracks)
    for (const Cluster& cluster : track.observations)
      for (const Eigen::Vector3d& x : cluster.points) {
        const GroundSquare at = ground_square_of(x);
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) out[cluster.scan].insert({at.first + dx, at.second + dy});
      }
  return out;
}

}  // namespace

Contradictions contradictions_of(const ObstacleReturns& returns) {
  std::map<GroundSquare, int> votes;  // positive: most returns of the square move
  for (std::size_t i = 0; i < returns.points.size(); ++i)
    if (returns.witness[i] != Witness::unknown)
      votes[ground_square_of(returns.points[i])] += returns.witness[i] == Witness::moving ? 1 : -1;
  Contradictions out;
  out.judged = votes.size();
  for (const auto& [square, vote] : votes)
    if (vote > 0) out.moving.push_back(square);
  return out;
}

std::vector<std::size_t> find_contradictory_scans(const std::vector<Contradictions>& scans, const std::vector<Track>& tracks) {
  const std::vector<std::set<GroundSquare>> explained = explained_squares(scans.size(), tracks);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto& [judged, moving] = scans[i];
    const auto unexplained = static_cast<double>(
        std::count_if(moving.begin(), moving.end(), [&](const GroundSquare& at) { return !explained[i].contains(at); }));
    if (judged >= kMinJudgedSquares && unexplained > kMaxUnexplainedShare * static_cast<double>(judged)) out.push_back(i);
  }
  if (static_cast<double>(out.size()) > kMaxContradictoryShare * static_cast<double>(scans.size())) {
    out.resize(scans.size());
    std::iota(out.begin(), out.end(), std::size_t{0});
  }
  return out;
}

}  // namespace dvi::objects
