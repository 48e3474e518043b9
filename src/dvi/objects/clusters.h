#pragma once

#include <vector>

#include "dvi/objects/cluster_returns.h"
#include "dvi/objects/moving_returns.h"

namespace dvi::objects {

/// The moving returns of one scan that are close to each other: a candidate for one object.
struct Cluster {
  ClusterReturns returns;  ///< with those between them whose vote is unknown
  std::size_t scan = 0;    ///< index of the scan in the drive
  Eigen::Vector2d center;  ///< center of the bounding rectangle, world axes
  double extent_m = 0;     ///< longer side of the bounding rectangle
  std::int64_t mean_time_ns = 0;
  double moving_share = 0;  ///< share of moving returns among those whose vote is known
  int label_class = 0;      ///< the most frequent class of labeled returns (point_labels.h); 0 without labels
};

/// Adds return `i` to the cluster.
void add(Cluster& cluster, const ObstacleReturns& returns, std::size_t i);

/// Sets center, extent, and mean time from the returns. The cluster must have at least one.
void measure(Cluster& cluster);

/// Groups points in squares of an edge of `square_m` that touch, seen from above. Returns the group of each point.
std::vector<int> group_by_distance(const std::vector<Eigen::Vector3d>& points, double square_m);

/// Groups moving returns. Returns in squares of half a meter that touch, seen from above, belong to one cluster. A cluster has
/// at least five moving returns. The returns must have votes.
std::vector<Cluster> find_clusters(const ObstacleReturns& returns);

/// Groups labeled returns in the same way, those of different instances and of different kinds of traffic separately. They
/// count as moving, so that only their track shows whether they move.
std::vector<Cluster> find_labeled_clusters(const ObstacleReturns& returns);

}  // namespace dvi::objects
