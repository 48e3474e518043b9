#include "dvi/objects/stationary_phases.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dvi/core/threads.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct StationaryPhaseParams {
  /// Scans that judge whether the object has left its position. They are dense shortly after, and sparse later, when other
  /// objects may have passed the position.
  std::size_t max_judges = 20;
  double judge_spacing_growth = 1.2;  ///< ratio between consecutive time offsets of the judges
  std::size_t min_clear_scans = 3;    ///< consecutive scans that observe free space: a clear period
  std::size_t min_hit_scans = 2;      ///< scans that observe a surface at a stationary return
  double return_radius_m = 0.05;      ///< radius around a return that must be free
  double min_moving_share = 0.5;      ///< share of the returns of a cluster; rays pass glass and edges of parked vehicles, too
  double max_growth = 1.5;            ///< largest extent, relative to that of the object while it moved
  double max_hidden_vehicle_m = 3;    ///< length of a vehicle that may have been occluded while it moved
  double max_hidden_person_m = 1;     ///< likewise of a person; objects of a smaller extent are persons
  double max_miss_m = 1.5;            ///< distance between the predicted position and the nearest return
  double max_gap_s = 0.55;            ///< time without an observation of a moving object
  double max_stationary_gap_s = 3;    ///< likewise of a stationary one, which passing objects may occlude
  double stationary_speed_mps = 0.5;  ///< a slower object is stationary
  double search_margin_m = 3;         ///< margin of the search for returns around the last observation
  double max_stationary_motion_m = 0.3;  ///< distance between observations of a stationary object
  std::ptrdiff_t min_stationary_observations = 4;
  double max_stopping_speed_mps = 2;  ///< a slower object may cover its own position in all scans
  double max_step_m = 0.3;            ///< distance between two scans at this speed, with noise
};
constexpr StationaryPhaseParams kPhases{};

enum class Direction { backward, forward };

constexpr Direction opposite(Direction direction) {
  return direction == Direction::forward ? Direction::backward : Direction::forward;
}

// Extends one end of a track in one direction of time.
class TrackEnd {
 public:
  TrackEnd(Track& track, Direction direction, const MovingReturns& returns)
      : track_(track), direction_(direction), returns_(returns) {
    for (const Cluster& o : track.observations) longest_m_ = std::max(longest_m_, o.extent_m);
    choose_judges();
  }

  void extend() {
    const std::size_t known = track_.observations.size();
    add_observations();
    const std::size_t added = track_.observations.size() - known;
    if (!is_stationary_phase(added)) remove_observations(added);
  }

 private:
  // The returns of a scan near the last observation.
  struct NearReturns {
    std::size_t scan;
    ObstacleReturns returns;
    std::vector<std::size_t> clear, hits;  // per return: number of judges
  };

  void add_observations() {
    if (judges_.size() < kPhases.min_clear_scans) return;
    const std::size_t all = returns_.scans();
    for (std::optional<Cluster> found = find_next(all); found;) {
      track_.observations.insert(is_forward() ? track_.observations.end() : track_.observations.begin(), std::move(*found));
      found = find_next(1);  // the next scan mostly shows the object, too
      if (!found) found = find_next(all);
    }
  }

  // Returns the next observation in at most `count` scans with returns. Each judge judges these scans together, because there
  // may be no memory for all judges.
  std::optional<Cluster> find_next(std::size_t count) const {
    std::vector<NearReturns> near = collect_near(count);
    judge(near);
    for (NearReturns& scan : near) {
      vote(scan);
      if (std::optional<Cluster> cluster = find_in(scan.returns)) {
        cluster->scan = scan.scan;
        return cluster;
      }
    }
    return std::nullopt;
  }

  // Collects the returns of at most `count` scans with returns after the last observation, up to the largest gap.
  std::vector<NearReturns> collect_near(std::size_t count) const {
    const double max_gap_s = is_stationary() ? kPhases.max_stationary_gap_s : kPhases.max_gap_s;
    std::vector<NearReturns> out;
    for (auto next = next_scan(last().scan, direction_); next && out.size() < count; next = next_scan(*next, direction_)) {
      const auto returns = returns_.obstacles(*next);
      if (returns->points.empty()) continue;
      if (compute_gap_s(returns->time_ns[returns->time_ns.size() / 2]) > max_gap_s) break;
      out.push_back({*next, select_near(*returns), {}, {}});
    }
    return out;
  }

  bool is_stationary_phase(std::size_t added) const {
    const auto& observations = track_.observations;
    const auto begin = is_forward() ? observations.end() - static_cast<std::ptrdiff_t>(added) : observations.begin();
    const auto stationary = std::count_if(begin, begin + static_cast<std::ptrdiff_t>(added), [&](const Cluster& o) {
      return (o.center - last().center).norm() < kPhases.max_stationary_motion_m;
    });
    return stationary >= kPhases.min_stationary_observations;
  }

  void remove_observations(std::size_t added) {
    auto& observations = track_.observations;
    const auto begin = is_forward() ? observations.end() - static_cast<std::ptrdiff_t>(added) : observations.begin();
    observations.erase(begin, begin + static_cast<std::ptrdiff_t>(added));
  }

  bool is_forward() const { return direction_ == Direction::forward; }
  std::size_t index() const { return is_forward() ? track_.observations.size() - 1 : 0; }
  const Cluster& last() const { return track_.observations[index()]; }
  bool is_stationary() const { return track_.velocity(index()).norm() < kPhases.stationary_speed_mps; }
  double compute_gap_s(std::int64_t time_ns) const { return std::abs(seconds_between(last().mean_time_ns, time_ns)); }
  std::optional<std::size_t> next_scan(std::size_t scan, Direction direction, std::size_t offset = 1) const {
    const bool forward = direction == Direction::forward;
    if (forward ? scan + offset >= returns_.scans() : scan < offset) return std::nullopt;
    return forward ? scan + offset : scan - offset;
  }

  // The judges are on the other side of this end: scans while the object moved, and beyond.
  void choose_judges() {
    double offset = 1;
    while (const auto scan = next_scan(last().scan, opposite(direction_), static_cast<std::size_t>(offset))) {
      if (returns_.can_observe(*scan, last().center)) judges_.push_back(*scan);
      if (judges_.size() == kPhases.max_judges) return;
      offset = std::max(offset + 1, std::floor(kPhases.judge_spacing_growth * offset));
    }
  }

  // Returns the distance between the predicted position and the nearest return of a cluster. The center of the returns is not
  // used, because it shifts if the object is partly occluded.
  double compute_miss_m(const Cluster& cluster) const {
    const Eigen::Vector2d expected =
        last().center + track_.velocity(index()) * seconds_between(last().mean_time_ns, cluster.mean_time_ns);
    double nearest_m = kPhases.max_miss_m;
    for (const ClusterReturn& r : cluster.returns) nearest_m = std::min(nearest_m, (r.point.head<2>() - expected).norm());
    return nearest_m;
  }

  bool fits(const Cluster& cluster) const {
    const double hidden_m =
        longest_m_ < kPhases.max_hidden_person_m ? kPhases.max_hidden_person_m : kPhases.max_hidden_vehicle_m;
    const double longest_m = kPhases.max_growth * longest_m_ + hidden_m;
    return cluster.moving_share >= kPhases.min_moving_share && cluster.extent_m <= longest_m;
  }

  std::optional<Cluster> find_in(const ObstacleReturns& near) const {
    std::optional<Cluster> best;
    double best_miss_m = kPhases.max_miss_m;
    for (Cluster& cluster : find_clusters(near)) {
      const double miss_m = compute_miss_m(cluster);
      if (!fits(cluster) || miss_m >= best_miss_m) continue;
      best_miss_m = miss_m;
      best = std::move(cluster);
    }
    return best;
  }

  ObstacleReturns select_near(const ObstacleReturns& returns) const {
    const double motion_m = is_stationary() ? 0 : kPhases.max_gap_s * track_.velocity(index()).norm();
    const double radius_m = longest_m_ + kPhases.search_margin_m + motion_m;
    ObstacleReturns near;
    for (std::size_t i = 0; i < returns.points.size(); ++i) {
      if ((returns.points[i].head<2>() - last().center).norm() > radius_m) continue;
      near.points.push_back(returns.points[i]);
      near.time_ns.push_back(returns.time_ns[i]);
      near.ground.push_back(returns.ground[i]);
      near.ray_spacing_m.push_back(returns.ray_spacing_m[i]);
    }
    return near;
  }

  void judge(std::vector<NearReturns>& near) const {
    for (NearReturns& scan : near) {
      scan.clear.resize(scan.returns.points.size(), 0);
      scan.hits.resize(scan.returns.points.size(), 0);
    }
    for (const std::size_t number : judges_) {
      const auto space = returns_.free_space(number);
      if (!space->valid()) continue;
      for (auto& [scan, returns, clear, hits] : near)
        for (std::size_t i = 0; i < returns.points.size(); ++i) {
          if (clear[i] >= kPhases.min_clear_scans) continue;
          const FreeSpace::Seen state = space->judge(returns.points[i], kPhases.return_radius_m);
          if (state == FreeSpace::Seen::passed) ++clear[i];
          if (state != FreeSpace::Seen::hit) continue;
          clear[i] = 0;
          ++hits[i];
        }
    }
  }

  void vote(NearReturns& near) const {
    auto& [scan, returns, clear, hits] = near;
    const bool slow = track_.velocity(index()).norm() < kPhases.max_stopping_speed_mps;
    for (std::size_t i = 0; i < returns.points.size(); ++i)
      returns.vote.push_back(clear[i] >= kPhases.min_clear_scans              ? VisibilityVote::moving
                             : hits[i] >= kPhases.min_hit_scans               ? VisibilityVote::stationary
                             : slow && is_at_last_position(returns.points[i]) ? VisibilityVote::moving
                                                                              : VisibilityVote::unknown);
  }

  // The object may hide its own position from all judges, as a vehicle does that drives straight ahead and stops.
  bool is_at_last_position(const Eigen::Vector3d& x) const {
    const ClusterReturns& known = last().returns;
    return std::any_of(known.begin(), known.end(),
                       [&](const ClusterReturn& r) { return (x.head<2>() - r.point.head<2>()).norm() < kPhases.max_step_m; });
  }

  Track& track_;
  Direction direction_;
  const MovingReturns& returns_;
  double longest_m_ = 0;
  std::vector<std::size_t> judges_;  // scans, in order of their time offset
};

}  // namespace

std::vector<Track> extend_through_stationary_phases(std::vector<Track> tracks, const MovingReturns& returns) {
  parallel_in_order(tracks.size(), [&](std::size_t i) {
    for (const Direction direction : {Direction::backward, Direction::forward})
      TrackEnd(tracks[i], direction, returns).extend();
  });
  return tracks;
}

}  // namespace dvi::objects
