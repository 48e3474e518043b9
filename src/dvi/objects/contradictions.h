#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The places at which one scan contradicts the others, on a grid of ground squares.
struct Contradictions {
  std::size_t judged = 0;                   ///< Squares of which other scans tell something.
  std::vector<std::pair<int, int>> moving;  ///< Those of them most of whose returns move.
};
Contradictions contradictions_of(const ObstacleReturns& returns);

/// Returns the scans of which a large share of the squares moves without being part of a tracked object. Traffic moves along
/// tracks; what contradicts the other scans without forming any shows that the pose of the scan is wrong. All scans if these
/// are more than a third of them.
std::vector<std::size_t> find_contradictory_scans(const std::vector<Contradictions>& scans, const std::vector<Track>& tracks);

}  // namespace dvi::objects
