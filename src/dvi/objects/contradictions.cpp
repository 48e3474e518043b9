#include "dvi/objects/contradictions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace dvi::objects {
namespace {

using GroundSquare = std::pair<int, int>;

struct ContradictionParams {
  double square_m = 0.5;
  std::size_t min_judged_squares = 30;       ///< scans with fewer squares are not judged
  double max_unexplained_share = 0.06;       ///< share of moving squares outside of tracks that a correct pose explains
  double max_contradictory_share = 1.0 / 3;  ///< share of contradictory scans beyond which no scan is used
};
constexpr ContradictionParams kContradiction{};

GroundSquare to_ground_square(const Eigen::Vector3d& x) {
  return {static_cast<int>(std::floor(x.x() / kContradiction.square_m)),
          static_cast<int>(std::floor(x.y() / kContradiction.square_m))};
}

// Returns, per scan, the squares of the tracked objects and those that touch them.
std::vector<std::set<GroundSquare>> find_explained_squares(std::size_t scans, const std::vector<Track>& tracks) {
  std::vector<std::set<GroundSquare>> out(scans);
  for (const Track& track : tracks)
    for (const Cluster& cluster : track.observations)
      for (const ClusterReturn& r : cluster.returns) {
        const GroundSquare at = to_ground_square(r.point);
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) out[cluster.scan].insert({at.first + dx, at.second + dy});
      }
  return out;
}

}  // namespace

Contradictions find_contradictions(const ObstacleReturns& returns) {
  std::map<GroundSquare, int> votes;  // positive: most returns of the square move
  for (std::size_t i = 0; i < returns.points.size(); ++i)
    if (returns.vote[i] != VisibilityVote::unknown)
      votes[to_ground_square(returns.points[i])] += returns.vote[i] == VisibilityVote::moving ? 1 : -1;
  Contradictions out;
  out.judged = votes.size();
  for (const auto& [square, vote] : votes)
    if (vote > 0) out.moving.push_back(square);
  return out;
}

std::vector<std::size_t> find_contradictory_scans(const std::vector<Contradictions>& scans, const std::vector<Track>& tracks) {
  const std::vector<std::set<GroundSquare>> explained = find_explained_squares(scans.size(), tracks);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto& [judged, moving] = scans[i];
    const auto unexplained = static_cast<double>(
        std::count_if(moving.begin(), moving.end(), [&](const GroundSquare& at) { return !explained[i].contains(at); }));
    if (judged >= kContradiction.min_judged_squares &&
        unexplained > kContradiction.max_unexplained_share * static_cast<double>(judged))
      out.push_back(i);
  }
  if (static_cast<double>(out.size()) > kContradiction.max_contradictory_share * static_cast<double>(scans.size())) {
    out.resize(scans.size());
    std::iota(out.begin(), out.end(), std::size_t{0});
  }
  return out;
}

}  // namespace dvi::objects
