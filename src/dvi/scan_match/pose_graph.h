#pragma once

#include <cstddef>
#include <vector>

#include "dvi/geometry/se3.h"

namespace dvi::scan_match {

/// A measured motion between two poses.
struct PoseEdge {
  std::size_t a = 0, b = 0;
  SE3 a_from_b;
  Matrix6d information;    ///< inverse covariance: translation (m), rotation (rad), in the axes of b
  bool uncertain = false;  ///< loses weight if it contradicts the others, as a false loop does
};

/// Optimizes the poses, except the first one, for the best agreement of world_from_a^-1 * world_from_b with the edges:
/// Gauss-Newton on SE(3), with Geman-McClure's loss for uncertain edges, narrowed step by step (graduated non-convexity, Yang
/// et al. 2020). Returns the weight of each edge, 0 to 1. The edges must connect all poses. Eigen's sparse Cholesky is
/// sufficient for one kind of residual; Ceres would add a dozen packages.
std::vector<double> solve_pose_graph(std::vector<SE3>& world_from_body, const std::vector<PoseEdge>& edges);

/// A solved pose graph.
struct PoseGraph {
  std::vector<SE3> world_from_body;
  std::vector<PoseEdge> edges;
  std::vector<double> weights;  ///< of the edges, as returned by solve_pose_graph()
};

/// Returns the covariance of world_from_a^-1 * world_from_b at the solution for the weighted edges: translation and rotation in
/// the axes of b. It assumes independent edges and is too small if errors of neighboring edges are correlated.
Matrix6d compute_relative_covariance(PoseGraph graph, std::size_t a, std::size_t b);

}  // namespace dvi::scan_match
