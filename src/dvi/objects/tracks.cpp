#include "dvi/objects/tracks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dvi/core/median.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/objects/assign_tracks.h"
#include "dvi/objects/seconds.h"

namespace dvi::objects {
namespace {

struct TrackingParams {
  double max_gap_s = 0.55;            ///< time without an observation after which a track ends
  double max_speed_mps = 40;          ///< between the first two observations
  double gate_m = 1;                  ///< distance between prediction and observation, without acceleration
  double max_acceleration_mps2 = 10;  ///< hard braking
  double min_heading_speed_mps = 1;   ///< below, the heading is that of another observation
  double top_band_m = 0.4;            ///< height of the upper edge of an object ...
  double top_band_rays = 1.2;         ///< ... and its height in ray spacings
  double velocity_window_s = 0.5;     ///< time before and after over which a velocity is fitted
};
constexpr TrackingParams kTracking{};

struct MovingObjectParams {
  std::size_t min_observations = 4;
  double min_speed_mps = 0.3;     ///< slower observations have no vote: other scans hit an object that waits
  double min_moving_share = 0.5;  ///< median share of returns in space that other scans observed as free
  /// The same for a track that travels far: scans hit the side of a long, slow van again, so that fewer of its returns look
  /// moving.
  double min_far_moving_share = 1.0 / 3;
  double far_distance_lengths = 3;        ///< distance of such a track, in lengths of the object
  std::size_t min_far_observations = 10;  ///< observations of such a track
  double min_distance_m = 1;              ///< errors of poses, and changes of the visible side, are smaller
  double max_deviation = 0.25;            ///< deviation from a smooth motion, relative to the distance
  double min_straightness = 0.5;          ///< ratio of distance and path length
};
constexpr MovingObjectParams kMovingObject{};

// Returns the distance between an observation and the prediction of a track, or nothing if it cannot be its next observation.
std::optional<double> measure_miss(const Track& track, const Cluster& cluster) {
  const Cluster& last = track.observations.back();
  const double dt = seconds_between(last.mean_time_ns, cluster.mean_time_ns);
  if (dt >= kTracking.max_gap_s) return std::nullopt;
  const Eigen::Vector2d step = cluster.center - last.center;
  if (track.observations.size() == 1) {
    if (step.norm() < kTracking.max_speed_mps * dt + kTracking.gate_m) return step.norm();
    return std::nullopt;
  }
  const double miss = (step - track.velocity(track.observations.size() - 1) * dt).norm();
  if (miss < kTracking.gate_m + 0.5 * kTracking.max_acceleration_mps2 * dt * dt + 0.5 * last.extent_m) return miss;
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Vector2d> Track::heading(std::size_t observation) const {
  for (std::size_t offset = 0; offset < observations.size(); ++offset)
    for (const bool later : {false, true}) {
      if (later ? observation + offset >= observations.size() : offset > observation) continue;
      const Eigen::Vector2d velocity_mps = velocity(later ? observation + offset : observation - offset);
      if (velocity_mps.norm() > kTracking.min_heading_speed_mps) return velocity_mps.normalized();
    }
  return std::nullopt;
}

Track::State Track::state(std::size_t observation) const {
  const std::int64_t origin = observations[observation].mean_time_ns;
  double n = 0, t = 0, tt = 0;
  Eigen::Vector2d x = Eigen::Vector2d::Zero(), tx = Eigen::Vector2d::Zero();
  const auto outside = [&](const Cluster& o) {
    return std::abs(seconds_between(origin, o.mean_time_ns)) > kTracking.velocity_window_s;
  };
  std::size_t first = observation;
  while (first > 0 && !outside(observations[first - 1])) --first;
  for (std::size_t i = first; i < observations.size() && !outside(observations[i]); ++i) {
    const Cluster& o = observations[i];
    const double dt = seconds_between(origin, o.mean_time_ns);
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

double top_of(const Cluster& cluster) {
  double top = cluster.returns.front().point.z();
  for (const ClusterReturn& r : cluster.returns) top = std::max(top, r.point.z());
  return top;
}

bool is_near_top(const ClusterReturn& at, double top_m) {
  const double band_m = std::max(kTracking.top_band_m, kTracking.top_band_rays * at.ray_spacing_m);
  return at.point.z() >= top_m - band_m;
}

bool is_moving_object(const Track& track) {
  const auto& observations = track.observations;
  if (observations.size() < kMovingObject.min_observations) return false;
  std::vector<double> shares, extents;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    extents.push_back(observations[i].extent_m);
    if (track.velocity(i).norm() >= kMovingObject.min_speed_mps) shares.push_back(observations[i].moving_share);
  }
  if (shares.size() < kMovingObject.min_observations) return false;
  double distance_m = 0, path_m = 0, deviation_m2 = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < observations.size(); ++i)
    deviation_m2 += (observations[i].center - track.state(i).position).squaredNorm() / static_cast<double>(observations.size());
  for (std::size_t i = 1; i < observations.size(); ++i) {
    const Cluster& o = observations[i];
    distance_m = std::max(distance_m, (o.center - observations.front().center).norm());
    // Steps are long, so that noise does not add to the path length.
    if (seconds_between(observations[last].mean_time_ns, o.mean_time_ns) < kTracking.velocity_window_s &&
        i + 1 < observations.size())
      continue;
    path_m += (o.center - observations[last].center).norm();
    last = i;
  }
  const double share = median(shares), extent_m = median(extents);
  const bool far = observations.size() >= kMovingObject.min_far_observations &&
                   distance_m >= kMovingObject.far_distance_lengths * std::max(extent_m, kMovingObject.min_distance_m);
  return share >= (far ? kMovingObject.min_far_moving_share : kMovingObject.min_moving_share) &&
         distance_m >= std::max(kMovingObject.min_distance_m, 0.5 * extent_m) &&
         distance_m >= kMovingObject.min_straightness * path_m &&
         std::sqrt(deviation_m2) < kMovingObject.max_deviation * distance_m;
}

void Tracker::add(std::vector<Cluster> clusters) {
  std::vector<TrackCandidate> candidates;
  for (std::size_t t = 0; t < active_.size(); ++t)
    for (std::size_t c = 0; c < clusters.size(); ++c)
      if (const auto miss = measure_miss(active_[t], clusters[c])) candidates.push_back({*miss, t, c});
  const std::vector<std::optional<std::size_t>> track_of = assign_tracks(std::move(candidates), clusters.size());
  std::int64_t now = 0;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    now = std::max(now, clusters[c].mean_time_ns);
    if (track_of[c])
      active_[*track_of[c]].observations.push_back(std::move(clusters[c]));
    else
      active_.push_back({{std::move(clusters[c])}});
  }
  const auto ended = std::stable_partition(active_.begin(), active_.end(), [&](const Track& track) {
    return seconds_between(track.observations.back().mean_time_ns, now) < kTracking.max_gap_s;
  });
  for (auto track = ended; track != active_.end(); ++track)
    if (is_object_(*track)) ended_.push_back(std::move(*track));
  active_.erase(ended, active_.end());
}

std::vector<Track> Tracker::finish() {
  for (Track& track : active_)
    if (is_object_(track)) ended_.push_back(std::move(track));
  active_.clear();
  return std::move(ended_);
}

}  // namespace dvi::objects
