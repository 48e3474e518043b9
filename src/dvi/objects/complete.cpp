#include "dvi/objects/complete.h"

#include <cmath>
#include <memory>
#include <utility>

#include "dvi/core/threads.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

constexpr double kShapeWindow = 0.35;  // seconds each way, three scans: over longer, the error of the speed adds up

// Adds the returns of another scan, as they stand at the time of this one. Those in plain sight of this scan would only be
// smeared by the error of the speed.
void add_hidden(const Cluster& other, const Eigen::Vector2d& velocity, const FreeSpace& seen, Cluster& cluster) {
  for (std::size_t k = 0; k < other.points.size(); ++k) {
    Eigen::Vector3d x = other.points[k];
    x.head<2>() += velocity * seconds_from(other.time_ns[k], cluster.mean_time_ns);
    if (seen.judge(x, 0) != FreeSpace::Seen::hidden) continue;
    cluster.points.push_back(x);
    cluster.time_ns.push_back(cluster.mean_time_ns);
    cluster.ground.push_back(other.ground[k]);
    cluster.rise.push_back(other.rise[k]);
  }
}

Cluster complete(const Track& track, std::size_t at, const FreeSpace& seen) {
  Cluster cluster = track.observations[at];
  const Eigen::Vector2d velocity = track.velocity(at);
  for (std::size_t j = 0; j < track.observations.size(); ++j) {
    const Cluster& other = track.observations[j];
    if (j != at && std::abs(seconds_from(other.mean_time_ns, cluster.mean_time_ns)) < kShapeWindow)
      add_hidden(other, velocity, seen, cluster);
  }
  return cluster;
}

}  // namespace

std::vector<Track> completed(const std::vector<Track>& tracks, const MovingReturns& returns) {
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> seen(returns.scans());  // track, observation
  for (std::size_t k = 0; k < tracks.size(); ++k)
    for (std::size_t i = 0; i < tracks[k].observations.size(); ++i) seen[tracks[k].observations[i].scan].emplace_back(k, i);
  std::vector<Track> out = tracks;
  for_blocks(seen.size(), [&](std::size_t first, std::size_t last) {
    parallel_for(last - first, [&](std::size_t i) {
      if (seen[first + i].empty()) return;
      const std::shared_ptr<const FreeSpace> space = returns.free_space(first + i);
      for (const auto& [k, o] : seen[first + i]) out[k].observations[o] = complete(tracks[k], o, *space);
    });
  });
  return out;
}

}  // namespace dvi::objects
