#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/objects/clusters.h"

namespace dvi::objects {

/// One object over time.
struct Track {
  std::vector<Cluster> observations;  ///< one a scan, in order of time
  double height_m = 0;                ///< above the ground: the median over its scans
  Eigen::Vector2d size_m{0, 0};       ///< along and across its way, as its scans show it at best; 0: unknown

  /// Where it is and how fast, meters a second, at an observation: a line through those within half a second.
  struct State {
    Eigen::Vector2d place, velocity;
  };
  State state(std::size_t observation) const;
  Eigen::Vector2d velocity(std::size_t observation) const { return state(observation).velocity; }
  /// The direction in which it moves at an observation, or at the nearest one at which it moves fast enough to have a
  /// direction; none if there is no such observation.
  std::optional<Eigen::Vector2d> heading(std::size_t observation) const;
  /// The observation nearest to a time; there is one at least.
  std::size_t nearest(std::int64_t time_ns) const;
};

inline constexpr double kGoesOn = 1;  ///< seconds for which a motion goes on unseen

/// Whether what was tracked is an object that moves of itself: it gets somewhere, straight enough, and what it leaves is
/// free. Glass, edges and leaves that rays pass now and then do none of this.
bool moves(const Track& track);

/// Ties the clusters of following scans together: constant velocity, nearest first. What is not seen for half a second has
/// ended.
class Tracker {
 public:
  /// The clusters of the next scan.
  void add(std::vector<Cluster> clusters);
  /// All tracks that move.
  std::vector<Track> finish();

 private:
  std::vector<Track> active_, ended_;
};

}  // namespace dvi::objects
