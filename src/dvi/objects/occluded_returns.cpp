#include "dvi/objects/occluded_returns.h"

#include <cmath>
#include <memory>
#include <utility>

#include "dvi/core/threads.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

// Time to the scans whose returns are added, in seconds: three scans. Over a longer time, the error of the velocity
// accumulates.
constexpr double kMaxOcclusionGapS = 0.35;

// Adds the returns of another scan, moved to the time of this one. Those that this scan observes are left out: they would be
// smeared by the error of the velocity.
void add_occluded(const Cluster& other, const Eigen::Vector2d& velocity, const FreeSpace& free_space, Cluster& cluster) {
  for (std::size_t k = 0; k < other.points.size(); ++k) {
    Eigen::Vector3d x = other.points[k];
    x.head<2>() += velocity * seconds_between(other.time_ns[k], cluster.mean_time_ns);
    if (free_space.judge(x, 0) != FreeSpace::Seen::hidden) continue;
    cluster.points.push_back(x);
    cluster.time_ns.push_back(cluster.mean_time_ns);
    cluster.ground.push_back(other.ground[k]);
    cluster.ray_spacing_m.push_back(other.ray_spacing_m[k]);
  }
}

Cluster complete_observation(const Track& track, std::size_t observation, const FreeSpace& free_space) {
  Cluster cluster = track.observations[observation];
  const Eigen::Vector2d velocity = track.velocity(observation);
  for (std::size_t j = 0; j < track.observations.size(); ++j) {
    const Cluster& other = track.observations[j];
    if (j != observation && std::abs(seconds_between(other.mean_time_ns, cluster.mean_time_ns)) < kMaxOcclusionGapS)
      add_occluded(other, velocity, free_space, cluster);
  }
  cluster.points.shrink_to_fit();  // the observations of all tracks are kept until the objects of the drive are drawn
  cluster.time_ns.shrink_to_fit();
  cluster.ground.shrink_to_fit();
  cluster.ray_spacing_m.shrink_to_fit();
  return cluster;
}

}  // namespace

std::vector<Track> add_occluded_returns(const std::vector<Track>& tracks, const MovingReturns& returns) {
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> observed(returns.scans());  // per scan: track, observation
  for (std::size_t k = 0; k < tracks.size(); ++k)
    for (std::size_t i = 0; i < tracks[k].observations.size(); ++i) observed[tracks[k].observations[i].scan].emplace_back(k, i);
  std::vector<Track> out = tracks;
  parallel_in_order(observed.size(), [&](std::size_t i) {
    if (observed[i].empty()) return;
    const std::shared_ptr<const FreeSpace> free_space = returns.free_space(i);
    for (const auto& [k, o] : observed[i]) out[k].observations[o] = complete_observation(tracks[k], o, *free_space);
  });
  return out;
}

}  // namespace dvi::objects
