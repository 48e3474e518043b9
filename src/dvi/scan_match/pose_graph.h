#pragma once

#include <cstddef>
#include <vector>

#include "dvi/geometry/se3.h"

namespace dvi::scan_match {

/// A measured motion between two poses.
struct PoseEdge {
  std::size_t a = 0, b = 0;
  SE3 a_from_b;
  Matrix6d information;   ///< inverse covariance: translation (m), rotation (rad), in the axes of b
  bool doubtful = false;  ///< gives way where it contradicts the others, as a loop may that is none
};

/// Moves the poses, all but the first, to where world_from_a^-1 * world_from_b agrees best with the edges: Gauss-Newton on
/// SE(3), doubtful edges under Geman-McClure's loss, narrowed step by step (graduated non-convexity, Yang et al. 2020).
/// Returns the weight of each edge, 0 to 1. Edges must tie all poses together. Eigen's sparse Cholesky does for one kind of
/// residual; Ceres would bring a dozen packages.
std::vector<double> solve_pose_graph(std::vector<SE3>& world_from_body, const std::vector<PoseEdge>& edges);

/// Covariance of world_from_a^-1 * world_from_b at the solution, by the edges as they are weighted: translation, rotation, in
/// the axes of b. The edges' information is taken at its word: what errors of neighboring edges share makes it too small.
Matrix6d relative_covariance(std::vector<SE3> world_from_body, const std::vector<PoseEdge>& edges, std::vector<double> weights,
                             std::size_t a, std::size_t b);

}  // namespace dvi::scan_match
