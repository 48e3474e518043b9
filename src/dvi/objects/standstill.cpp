#include "dvi/objects/standstill.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dvi/core/threads.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

// Scans that judge whether the object has left its place: dense shortly after, sparse later, where other traffic may have
// passed over the place.
constexpr std::size_t kMaxJudges = 20;
constexpr double kJudgeSpacingGrowth = 1.2;
constexpr std::size_t kMinClearScans = 3;   // that observe free space one after the other: a clear period
constexpr std::size_t kMinStaticScans = 2;  // that observe something at the place
constexpr double kReturnRadiusM = 0.05;
constexpr double kMinClearedShare = 0.5;  // of a cluster's returns; rays pass the glass and the edges of parked vehicles, too
constexpr double kMaxGrowth = 1.5;        // of the extent of the object
constexpr double kMaxHiddenLengthM = 3;   // of a vehicle of which only a part was observed while it moved
constexpr double kMaxPersonM = 1;
constexpr double kMaxMissM = 1.5;
constexpr double kMaxGapS = 0.55;
constexpr double kMaxStandingGapS = 3;  // for which passing traffic may hide an object that stands still
constexpr double kMaxStandingSpeedMps = 0.5;
constexpr double kSearchMarginM = 3;
constexpr double kMaxStandingMotionM = 0.3;
constexpr std::ptrdiff_t kMinStandingObservations = 4;
constexpr double kMaxStoppingSpeedMps = 2;
constexpr double kMaxStepM = 0.3;  // between two scans, at that speed and with noise

// One end of a track, from which it goes on in one direction of time.
class End {
 public:
  End(Track& track, bool forward, const MovingReturns& returns) : track_(track), forward_(forward), returns_(returns) {
    for (const Cluster& o : track.observations) longest_m_ = std::max(longest_m_, o.extent_m);
    choose_judges();
  }

  void extend() {
    const std::size_t known = track_.observations.size();
    add_observations();
    if (!reaches_standstill(track_.observations.size() - known)) remove_observations(track_.observations.size() - known);
  }

 private:
  void add_observations() {
    if (judges_.size() < kMinClearScans) return;
    for (auto next = next_scan(last().scan, forward_); next; next = next_scan(*next, forward_)) {
      const auto returns = returns_.obstacles(*next);
      if (returns->points.empty()) continue;
      if (gap_s(returns->time_ns[returns->time_ns.size() / 2]) > (stands() ? kMaxStandingGapS : kMaxGapS)) return;
      if (auto cluster = find_in(*returns)) {
        cluster->scan = *next;
        track_.observations.insert(forward_ ? track_.observations.end() : track_.observations.begin(), std::move(*cluster));
      }
    }
  }

  bool reaches_standstill(std::size_t added) const {
    const auto& seen = track_.observations;
    const auto begin = forward_ ? seen.end() - static_cast<std::ptrdiff_t>(added) : seen.begin();
    const auto standing = std::count_if(begin, begin + static_cast<std::ptrdiff_t>(added), [&](const Cluster& o) {
      return (o.center - last().center).norm() < kMaxStandingMotionM;
    });
    return standing >= kMinStandingObservations;
  }

  void remove_observations(std::size_t added) {
    auto& seen = track_.observations;
    const auto begin = forward_ ? seen.end() - static_cast<std::ptrdiff_t>(added) : seen.begin();
    seen.erase(begin, begin + static_cast<std::ptrdiff_t>(added));
  }

  std::size_t index() const { return forward_ ? track_.observations.size() - 1 : 0; }
  const Cluster& last() const { return track_.observations[index()]; }
  bool stands() const { return track_.velocity(index()).norm() < kMaxStandingSpeedMps; }
  double gap_s(std::int64_t time_ns) const { return std::abs(seconds_from(last().mean_time_ns, time_ns)); }
  std::optional<std::size_t> next_scan(std::size_t scan, bool forward, std::size_t by = 1) const {
    if (forward ? scan + by >= returns_.scans() : scan < by) return std::nullopt;
    return forward ? scan + by : scan - by;
  }

  // On the other side of this end: while the object moved, and beyond.
  void choose_judges() {
    double offset = 1;
    while (const auto scan = next_scan(last().scan, !forward_, static_cast<std::size_t>(offset))) {
      if (returns_.observes(*scan, last().center)) judges_.push_back(*scan);
      if (judges_.size() == kMaxJudges) return;
      offset = std::max(offset + 1, std::floor(kJudgeSpacingGrowth * offset));
    }
  }

  // Meters from the place where the object is expected to the nearest return of a cluster: of an object that is hidden in part,
  // the center of what is observed shifts.
  double miss_m(const Cluster& cluster) const {
    const Eigen::Vector2d expected =
        last().center + track_.velocity(index()) * seconds_from(last().mean_time_ns, cluster.mean_time_ns);
    double nearest_m = kMaxMissM;
    for (const Eigen::Vector3d& x : cluster.points) nearest_m = std::min(nearest_m, (x.head<2>() - expected).norm());
    return nearest_m;
  }

  bool fits(const Cluster& cluster) const {
    const double longest_m = kMaxGrowth * longest_m_ + (longest_m_ < kMaxPersonM ? kMaxPersonM : kMaxHiddenLengthM);
    return cluster.moving_share >= kMinClearedShare && cluster.extent_m <= longest_m;
  }

  std::optional<Cluster> find_in(const ObstacleReturns& returns) const {
    ObstacleReturns near = returns_near(returns);
    judge(near);
    std::optional<Cluster> best;
    double best_miss_m = kMaxMissM;
    for (Cluster& cluster : clusters_of(near)) {
      const double miss = miss_m(cluster);
      if (!fits(cluster) || miss >= best_miss_m) continue;
      best_miss_m = miss;
      best = std::move(cluster);
    }
    return best;
  }

  ObstacleReturns returns_near(const ObstacleReturns& returns) const {
    const double reach_m = longest_m_ + kSearchMarginM + (stands() ? 0 : kMaxGapS * track_.velocity(index()).norm());
    ObstacleReturns near;
    for (std::size_t i = 0; i < returns.points.size(); ++i) {
      if ((returns.points[i].head<2>() - last().center).norm() > reach_m) continue;
      near.points.push_back(returns.points[i]);
      near.time_ns.push_back(returns.time_ns[i]);
      near.ground.push_back(returns.ground[i]);
      near.rise.push_back(returns.rise[i]);
    }
    return near;
  }

  void judge(ObstacleReturns& returns) const {
    std::vector<std::size_t> clear(returns.points.size(), 0), hits(returns.points.size(), 0);
    for (const std::size_t scan : judges_) {
      const auto space = returns_.free_space(scan);
      if (!space->valid()) continue;
      for (std::size_t i = 0; i < returns.points.size(); ++i) {
        if (clear[i] >= kMinClearScans) continue;
        const FreeSpace::Seen seen = space->judge(returns.points[i], kReturnRadiusM);
        if (seen == FreeSpace::Seen::passed) ++clear[i];
        if (seen != FreeSpace::Seen::hit) continue;
        clear[i] = 0;
        ++hits[i];
      }
    }
    const bool slow = track_.velocity(index()).norm() < kMaxStoppingSpeedMps;
    for (std::size_t i = 0; i < returns.points.size(); ++i)
      returns.witness.push_back(clear[i] >= kMinClearScans                    ? Witness::moving
                                : hits[i] >= kMinStaticScans                  ? Witness::standing
                                : slow && is_at_last_place(returns.points[i]) ? Witness::moving
                                                                              : Witness::unknown);
  }

  // The object may hide the place at which it stands from all judges, as a vehicle does that drives straight ahead and stops.
  bool is_at_last_place(const Eigen::Vector3d& x) const {
    return std::any_of(last().points.begin(), last().points.end(),
                       [&](const Eigen::Vector3d& known) { return (x.head<2>() - known.head<2>()).norm() < kMaxStepM; });
  }

  Track& track_;
  bool forward_;
  const MovingReturns& returns_;
  double longest_m_ = 0;
  std::vector<std::size_t> judges_;  // in the order of their distance in time
};

}  // namespace

std::vector<Track> extend_through_standstill(std::vector<Track> tracks, const MovingReturns& returns) {
  parallel_in_order(tracks.size(), [&](std::size_t i) {
    for (const bool forward : {false, true}) End(tracks[i], forward, returns).extend();
  });
  return tracks;
}

}  // namespace dvi::objects
