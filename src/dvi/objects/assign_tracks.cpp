#include "dvi/objects/assign_tracks.h"

#include <algorithm>
#include <set>
#include <tuple>

namespace dvi::objects {

std::vector<std::optional<std::size_t>> assign_tracks(std::vector<TrackCandidate> candidates, std::size_t observations) {
  const auto key = [](const TrackCandidate& c) { return std::tie(c.cost, c.track, c.observation); };
  std::sort(candidates.begin(), candidates.end(),
            [&](const TrackCandidate& a, const TrackCandidate& b) { return key(a) < key(b); });
  std::vector<std::optional<std::size_t>> track_of(observations);
  std::set<std::size_t> assigned;
  for (const TrackCandidate& c : candidates)
    if (!track_of[c.observation] && assigned.insert(c.track).second) track_of[c.observation] = c.track;
  return track_of;
}

}  // namespace dvi::objects
