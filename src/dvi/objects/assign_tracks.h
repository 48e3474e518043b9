#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace dvi::objects {

/// A track that an observation may continue, by their indices.
struct TrackCandidate {
  double cost = 0;
  std::size_t track = 0, observation = 0;
};

/// Assigns tracks to observations, the pairs with the lowest cost first; among equals, those of earlier tracks. Each track and
/// each observation is assigned at most once. Returns the track of each observation.
std::vector<std::optional<std::size_t>> assign_tracks(std::vector<TrackCandidate> candidates, std::size_t observations);

}  // namespace dvi::objects
