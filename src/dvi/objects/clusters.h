#pragma once

#include <vector>

#include "dvi/objects/moving_returns.h"

namespace dvi::objects {

/// Returns of one scan that hang together and were found to move: what may be one object.
struct Cluster {
  std::vector<Eigen::Vector3d> points;  ///< meters, world axes; with those between them that nobody could tell
  std::vector<std::int64_t> time_ns;    ///< as `points`
  std::vector<double> ground;           ///< as `points`: height of the ground below
  std::vector<double> rise;             ///< as `points`: meters to the next ray above
  std::size_t scan = 0;                 ///< its number in the drive
  Eigen::Vector2d center;               ///< of the bounding rectangle
  double extent_m = 0;                  ///< its longer side
  std::int64_t mean_time_ns = 0;
  double moving_share = 0;  ///< of the returns of which other scans tell something
};

/// Adds return `i`.
void add(Cluster& cluster, const ObstacleReturns& returns, std::size_t i);

/// Sets center, extent and mean time by the points, of which there is one at least.
void measure(Cluster& cluster);

/// Seen from above, squares of half a meter that touch belong together.
std::vector<Cluster> clusters_of(const ObstacleReturns& returns);

}  // namespace dvi::objects
