#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "dvi/objects/clusters.h"

namespace dvi::objects {

/// One object over time.
struct Track {
  std::vector<Cluster> observations;  ///< at most one per scan, in order of time
  double height_m = 0;                ///< height above the ground
  Eigen::Vector2d size_m{0, 0};       ///< size along and across its heading; 0 if unknown
  bool reaches_above_scans = false;   ///< its upper edge is above the highest returns, which images show

  /// Position in meters and velocity in m/s, world axes.
  struct State {
    Eigen::Vector2d position, velocity;
  };

  /// Estimates the state at an observation by a line fitted to the centers within half a second.
  State state(std::size_t observation) const;
  Eigen::Vector2d velocity(std::size_t observation) const { return state(observation).velocity; }
  /// Returns the direction of motion at an observation, or at the nearest one with a sufficient speed; nothing if there is
  /// none.
  std::optional<Eigen::Vector2d> heading(std::size_t observation) const;
  /// Returns the observation nearest to a time. There must be at least one.
  std::size_t nearest(std::int64_t time_ns) const;
};

/// The tracks of a drive. Objects refer to them, because copies of their returns would take much memory.
using SharedTracks = std::shared_ptr<const std::vector<Track>>;
using SharedTrack = std::shared_ptr<const Track>;

inline SharedTracks share_tracks(std::vector<Track> tracks) {
  return std::make_shared<const std::vector<Track>>(std::move(tracks));
}
inline SharedTrack share_track(const SharedTracks& tracks, std::size_t k) { return {tracks, &(*tracks)[k]}; }

/// Returns the height of the highest point of an observation, world axes. There must be at least one.
double top_of(const Cluster& cluster);

/// Returns whether a return of an observation is near its highest point, whose height is `top_m`.
bool is_near_top(const ClusterReturn& at, double top_m);

inline constexpr double kMaxExtrapolationS = 1;  ///< time for which the motion of an unobserved object is extrapolated

/// Returns whether a track is a moving object: it covers a distance on a straight and smooth path, and most of its returns lie
/// in space that other scans observed as free. Returns on glass, edges, and leaves do not meet these conditions.
bool is_moving_object(const Track& track);

/// Tracks the clusters of consecutive scans at constant velocity. The nearest pairs of track and cluster are assigned first. A
/// track that is unobserved for more than half a second ends.
class Tracker {
 public:
  /// Keeps the tracks for which `is_object` holds.
  explicit Tracker(bool (*is_object)(const Track&) = is_moving_object) : is_object_(is_object) {}
  /// Adds the clusters of the next scan.
  void add(std::vector<Cluster> clusters);
  /// Returns the tracks of objects.
  std::vector<Track> finish();

 private:
  bool (*is_object_)(const Track&);
  std::vector<Track> active_, ended_;
};

}  // namespace dvi::objects
