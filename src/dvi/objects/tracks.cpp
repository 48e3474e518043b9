#include "dvi/objects/tracks.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "dvi/core/median.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

constexpr double kLongestGap = 0.55;  // seconds without an observation
constexpr double kFastest = 40;       // meters a second
constexpr double kGate = 1;           // meters between prediction and observation
constexpr double kAcceleration = 10;  // meters a second squared: hard braking
constexpr double kMinDrivingSpeedMps = 1;
constexpr double kMinMovingSpeedMps = 0.3;      // below, other scans hit the object again: it waits
constexpr double kVelocityWindow = 0.5;         // seconds each way that a velocity is fitted over
constexpr std::size_t kFewestObservations = 4;  // observations of an object
constexpr double kMovingShare = 0.5;            // of its returns, those that lie where others saw through
// Scans that follow hit the side of a long, slow van again: fewer of its returns look moving, but it goes far.
constexpr double kSlidingShare = 1.0 / 3, kFar = 3;  // the distance, in its own lengths, that it gets
constexpr std::size_t kLong = 10;                    // observations of such a track
constexpr double kLeastWay = 1;                      // meters: labels, poses and the visible side of things wander less
constexpr double kOff = 0.25;                        // of the distance it gets, what it is off a smooth motion
constexpr double kStraight = 0.5;                    // of its way, the distance it gets

// How far an observation is from where the track should be; negative: it cannot be its next one.
double distance(const Track& track, const Cluster& cluster) {
  const Cluster& last = track.observations.back();
  const double dt = seconds_from(last.mean_time_ns, cluster.mean_time_ns);
  if (dt >= kLongestGap) return -1;  // the track has ended
  const Eigen::Vector2d step = cluster.center - last.center;
  if (track.observations.size() == 1) return step.norm() < kFastest * dt + kGate ? step.norm() : -1;
  const double miss = (step - track.velocity(track.observations.size() - 1) * dt).norm();
  return miss < kGate + 0.5 * kAcceleration * dt * dt + 0.5 * last.extent_m ? miss : -1;
}

}  // namespace

std::optional<Eigen::Vector2d> Track::heading(std::size_t observation) const {
  for (std::size_t apart = 0; apart < observations.size(); ++apart)
    for (const bool later : {false, true}) {
      if (later ? observation + apart >= observations.size() : apart > observation) continue;
      const Eigen::Vector2d at = velocity(later ? observation + apart : observation - apart);
      if (at.norm() > kMinDrivingSpeedMps) return at.normalized();
    }
  return std::nullopt;
}

Track::State Track::state(std::size_t observation) const {
  const std::int64_t origin = observations[observation].mean_time_ns;
  double n = 0, t = 0, tt = 0;
  Eigen::Vector2d x = Eigen::Vector2d::Zero(), tx = Eigen::Vector2d::Zero();
  const auto outside = [&](const Cluster& o) { return std::abs(seconds_from(origin, o.mean_time_ns)) > kVelocityWindow; };
  std::size_t first = observation;
  while (first > 0 && !outside(observations[first - 1])) --first;
  for (std::size_t i = first; i < observations.size() && !outside(observations[i]); ++i) {
    const Cluster& o = observations[i];
    const double dt = seconds_from(origin, o.mean_time_ns);
    n += 1, t += dt, tt += dt * dt;
    x += o.center, tx += dt * o.center;
  }
  const double spread = n * tt - t * t;
  if (n < 2 || spread < 1e-6) return {observations[observation].center, Eigen::Vector2d::Zero()};
  const Eigen::Vector2d velocity = (n * tx - t * x) / spread;
  return {(x - t * velocity) / n, velocity};
}

std::size_t Track::nearest(std::int64_t time_ns) const {
  const auto found = nearest_in_time(observations.begin(), observations.end(), time_ns, &Cluster::mean_time_ns);
  return static_cast<std::size_t>(found - observations.begin());
}

bool moves(const Track& track) {
  const auto& seen = track.observations;
  if (seen.size() < kFewestObservations) return false;
  std::vector<double> shares, extents;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    extents.push_back(seen[i].extent_m);
    if (track.velocity(i).norm() >= kMinMovingSpeedMps) shares.push_back(seen[i].moving_share);
  }
  if (shares.size() < kFewestObservations) return false;
  double farthest = 0, way = 0, off = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < seen.size(); ++i)
    off += (seen[i].center - track.state(i).place).squaredNorm() / static_cast<double>(seen.size());
  for (std::size_t i = 1; i < seen.size(); ++i) {
    farthest = std::max(farthest, (seen[i].center - seen.front().center).norm());
    if (seconds_from(seen[last].mean_time_ns, seen[i].mean_time_ns) < kVelocityWindow && i + 1 < seen.size()) continue;
    way += (seen[i].center - seen[last].center).norm();
    last = i;
  }
  const double share = median(shares), extent = median(extents);
  const bool goes_far = seen.size() >= kLong && farthest >= kFar * std::max(extent, kLeastWay);
  return share >= (goes_far ? kSlidingShare : kMovingShare) && farthest >= std::max(kLeastWay, 0.5 * extent) &&
         farthest >= kStraight * way && std::sqrt(off) < kOff * farthest;
}

void Tracker::add(std::vector<Cluster> clusters) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t t = 0; t < active_.size(); ++t)
    for (std::size_t c = 0; c < clusters.size(); ++c)
      if (const double d = distance(active_[t], clusters[c]); d >= 0) pairs.emplace_back(d, t, c);
  std::sort(pairs.begin(), pairs.end());
  std::vector<bool> track_taken(active_.size()), cluster_taken(clusters.size());
  for (const auto& [d, t, c] : pairs) {
    if (track_taken[t] || cluster_taken[c]) continue;
    track_taken[t] = cluster_taken[c] = true;
    active_[t].observations.push_back(clusters[c]);
  }
  std::int64_t now = 0;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    now = std::max(now, clusters[c].mean_time_ns);
    if (!cluster_taken[c]) active_.push_back({{std::move(clusters[c])}});
  }
  const auto ended = std::stable_partition(active_.begin(), active_.end(), [&](const Track& track) {
    return seconds_from(track.observations.back().mean_time_ns, now) < kLongestGap;
  });
  for (auto track = ended; track != active_.end(); ++track)
    if (moves(*track)) ended_.push_back(std::move(*track));
  active_.erase(ended, active_.end());
}

std::vector<Track> Tracker::finish() {
  for (Track& track : active_)
    if (moves(track)) ended_.push_back(std::move(track));
  active_.clear();
  return std::move(ended_);
}

}  // namespace dvi::objects
