#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "dvi/objects/moving_returns.h"
#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The ground squares of 0.5 m in which one scan contradicts the others.
struct Contradictions {
  std::size_t judged = 0;                   ///< number of squares with returns whose vote is known
  std::vector<std::pair<int, int>> moving;  ///< squares among them in which most returns move
};

/// Counts the squares of one scan. The returns must have votes.
Contradictions find_contradictions(const ObstacleReturns& returns);

/// Returns the scans in which a large share of the squares moves without being part of a tracked object. Objects move along
/// tracks. Contradictions that form no track show that the pose of the scan is wrong. If more than a third of the scans are
/// affected, all scans are returned.
std::vector<std::size_t> find_contradictory_scans(const std::vector<Contradictions>& scans, const std::vector<Track>& tracks);

}  // namespace dvi::objects
