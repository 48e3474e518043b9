#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/registration/key_scans.h"

namespace dvi::registration {

/// Parameters of the visibility vote.
struct RayVoteParams {
  double max_path_m = 12;         ///< path length from the key scan to the scans that vote, in both directions
  double scan_spacing_m = 4;      ///< path length between voting scans
  double point_radius_m = 0.1;    ///< radius of a point
  double position_error_m = 0.1;  ///< relative position error of the drives
  std::size_t point_step = 3;     ///< every third point is judged
};
inline constexpr RayVoteParams kRayVotes;

/// The votes of the rays of one drive on the upright points of another drive.
struct RayVotes {
  std::size_t hit = 0;     ///< points at which rays ended
  std::size_t passed = 0;  ///< points that rays passed through, so that nothing was there

  /// Returns the share of passed points among all points that rays reached; 0 if none did.
  double passed_share() const { return hit + passed > 0 ? static_cast<double>(passed) / static_cast<double>(hit + passed) : 0; }
};

/// Counts how many of the points the rays of a drive hit and passed (drive/free_space.h). The scans up to 12 m of path before
/// and after key scan `key` vote. `points_in_world` are in the world of `keys`. Rays also pass through some points in the right
/// place: cars that have left, leaves that have fallen.
RayVotes count_ray_votes(const KeyScans& keys, std::size_t key, const std::vector<Eigen::Vector3d>& points_in_world);

}  // namespace dvi::registration
