#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::registration {

/// Parameters of the pose graph over all drives. The standard deviations are of relative poses.
struct DriveGraphParams {
  double step_sigma_m = 0.01;           ///< of odometry, from one key scan to the next
  double step_sigma_rad = 0.0005;       ///< likewise
  double fixed_sigma = 1e-5;            ///< of a trajectory that must not change, in meters and radians
  double constraint_sigma_m = 0.02;     ///< added to the covariance of a scan constraint: errors of the local map
  double constraint_sigma_rad = 0.001;  ///< likewise
  double min_inlier_weight = 0.25;      ///< weight from which a constraint counts as an inlier
  std::size_t min_constraints = 3;      ///< of a source drive that is accepted
};
inline constexpr DriveGraphParams kDriveGraph;

/// A target or source drive with its trajectory.
struct DriveTrack {
  const Drive* drive = nullptr;
  Trajectory world_from_lidar;  ///< in the world of the target, or in any other world
  bool shares_world = false;    ///< true for a source drive whose poses are said to be in the target's world
  bool is_fixed = false;        ///< true for a target whose trajectory must not change
};

/// How well a source drive fits where it was placed.
struct PlacementFigures {
  SE3 target_from_source;             ///< from the world of its own trajectory: the mean over its key scans
  double overlap = 0;                 ///< share of its key scans that were registered to earlier drives
  double residual_m = 0;              ///< RMS distance to surfaces of these scans
  double bound_m = 0, bound_deg = 0;  ///< 95 % of the errors are smaller
  std::size_t landmarks = 0;          ///< landmarks that were checked (landmarks.h)
  std::size_t landmark_inliers = 0;   ///< landmarks that agree
  double passed_share = 0;            ///< share of upright points of one drive that rays of the other passed (ray_votes.h)
  double second_best_ratio = 0;       ///< score of the second best place, divided by the score of the best; 1: equally good
};

struct Placement {
  Trajectory world_from_lidar;  ///< in the target's world, deformed to fit the target; empty if no place was found
  PlacementFigures figures;     ///< of the best place, even if it was not accepted

  bool found() const { return !world_from_lidar.empty(); }
};

struct Registered {
  Trajectory target;               ///< the target's trajectory, deformed if the source drives constrain it
  std::vector<Placement> sources;  ///< one per source drive, in their order
};

/// Registers source drives to the target by their scans (docs/algorithms/registration.md; section 3.5 of the paper). Places are
/// recognized in views from above (bird_view.h). A drive whose poses are said to be in the target's world is searched there
/// first. A place is accepted if its landmarks agree (landmarks.h) and no other place scores nearly as well. From there each
/// key scan is registered to the scans of the drives placed so far, and one pose graph joins all drives. A source drive that
/// overlaps only with another source drive is placed by that drive. Reports one part of progress per source drive, "register".
Registered register_drives(const DriveTrack& target, const std::vector<DriveTrack>& sources,
                           const scan_match::MatchOptions& options, const BeginPart& begin = no_parts);

}  // namespace dvi::registration
