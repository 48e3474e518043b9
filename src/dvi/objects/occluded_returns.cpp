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

// Tracks with the numbers of the returns that the scans themselves show, per observation. Those that were added follow.
class ScannedTracks {
 public:
  explicit ScannedTracks(std::vector<Track> tracks) : tracks_(std::move(tracks)) {
    for (const Track& track : tracks_) {
      auto& counts = counts_.emplace_back();
      for (const Cluster& observation : track.observations) counts.push_back(observation.returns.size());
    }
  }

  // Finds the returns of other scans, moved to the time of observation `o` of track `k`, that are occluded in its scan. Those
  // that this scan observes are left out: they would be smeared by the error of the velocity.
  ClusterReturns find_occluded(std::size_t k, std::size_t o, const FreeSpace& free_space) const {
    const Track& track = tracks_[k];
    const std::int64_t time_ns = track.observations[o].mean_time_ns;
    const Eigen::Vector2d velocity = track.velocity(o);
    ClusterReturns out;
    for (std::size_t j = 0; j < track.observations.size(); ++j) {
      const Cluster& other = track.observations[j];
      if (j == o || std::abs(seconds_between(other.mean_time_ns, time_ns)) >= kMaxOcclusionGapS) continue;
      for (std::size_t i = 0; i < counts_[k][j]; ++i) {
        ClusterReturn r = other.returns[i];
        r.point.head<2>() += velocity * seconds_between(r.time_ns, time_ns);
        r.time_ns = time_ns;
        if (free_space.judge(r.point, 0) == FreeSpace::Seen::hidden) out.push_back(r);
      }
    }
    return out;
  }

  void add(std::size_t k, std::size_t o, const ClusterReturns& added) {
    ClusterReturns& returns = tracks_[k].observations[o].returns;
    for (const ClusterReturn& r : added) returns.push_back(r);
    returns.shrink_to_fit();  // the observations of all tracks are kept until the objects of the drive are drawn
  }

  const std::vector<Track>& tracks() const { return tracks_; }
  std::vector<Track> take() && { return std::move(tracks_); }

 private:
  std::vector<Track> tracks_;
  std::vector<std::vector<std::size_t>> counts_;
};

}  // namespace

std::vector<Track> add_occluded_returns(std::vector<Track> tracks, const MovingReturns& returns) {
  struct Observed {
    std::size_t track, observation;
    ClusterReturns occluded{};
  };
  ScannedTracks all(std::move(tracks));
  std::vector<std::vector<Observed>> observed(returns.scans());
  for (std::size_t k = 0; k < all.tracks().size(); ++k)
    for (std::size_t o = 0; o < all.tracks()[k].observations.size(); ++o)
      observed[all.tracks()[k].observations[o].scan].push_back({k, o});
  for_blocks(observed.size(), [&](std::size_t first, std::size_t last) {
    parallel_for(last - first, [&](std::size_t i) {
      if (observed[first + i].empty()) return;
      const std::shared_ptr<const FreeSpace> free_space = returns.free_space(first + i);
      for (auto& [k, o, occluded] : observed[first + i]) occluded = all.find_occluded(k, o, *free_space);
    });
    for (std::size_t i = first; i < last; ++i)
      for (auto& [k, o, occluded] : std::exchange(observed[i], {})) all.add(k, o, occluded);
  });
  return std::move(all).take();
}

}  // namespace dvi::objects
