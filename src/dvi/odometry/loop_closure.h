#pragma once

#include <cstddef>
#include <vector>

#include "dvi/odometry/odometry.h"

namespace dvi::odometry {

/// Distances at which loops are searched. The defaults are for a LiDAR on a vehicle.
struct LoopParams {
  double min_path_step_m = 0.5;     ///< shorter steps do not add to the path length: they are noise of a stationary car
  double min_path_m = 30;           ///< path length between two passes of a place
  double candidate_step_m = 5;      ///< path length from one candidate to the next
  double min_error_m = 5;           ///< possible error of a pose; it grows with the path length between the passes ...
  double drift = 0.03;              ///< ... by this share of it ...
  double max_error_m = 15;          ///< ... up to this
  double map_path_m = 15;           ///< path length of a place's map before and after the earlier pose
  double map_step_m = 2.5;          ///< path length between the scans of this map
  double check_path_m = 3;          ///< path length from the later scan back to the one that must agree
  double grid_step_m = 1;           ///< distance of the initial guesses
  bool is_level = true;             ///< the guesses have the height and attitude of the earlier pose: a car on a road
  double max_turn_rad = 4;          ///< between the two views; any for a sensor that covers all directions
  double min_relative_share = 0.7;  ///< share of matched static features, over that of a scan of the place itself
};

/// Parameters of the initial guesses.
struct LoopStartParams {
  double turn_step_rad = 0.035;
  double max_turn_rad = 0.12;
  std::size_t best_starts = 3;   ///< guesses that are registered
  std::size_t feature_step = 4;  ///< every fourth planar feature is scored
  double kernel_voxels = 0.6;    ///< distance in voxels at which a feature counts half
};
inline constexpr LoopStartParams kLoopStart;

/// Thresholds that a loop must meet. Noise is MatchOptions::noise_m, which grows with the other errors of the sensor.
struct LoopCheckParams {
  double max_relative_residual = 1.3;  ///< over the residual of a scan of the place itself ...
  double min_own_share = 0.1;          ///< ... which must have at least this share of matched static features
  double surface_noise = 5;            ///< distance of a matched feature to the surface, in units of noise
  double max_difference_noise = 5;     ///< of two scans with odometry between them, in units of noise
  double max_difference_rad = 0.01;    ///< likewise
};
inline constexpr LoopCheckParams kLoopCheck;

/// Standard deviations in the pose graph, added to those of registration; lengths are in units of MatchOptions::noise_m.
struct LoopGraphParams {
  double loop_noise = 2.0 / 3;
  double loop_rad = 0.001;
  double step_noise = 1.0 / 6;  ///< of odometry, from one scan to the next
  double step_rad = 0.0003;
  double lost_step_noise = 100.0 / 3;  ///< of a step to a scan that was lost
  double lost_step_rad = 0.05;
  double min_inlier_weight = 0.25;  ///< weight from which a loop counts as closed
};
inline constexpr LoopGraphParams kLoopGraph;

/// A place to which the drive returned.
struct Loop {
  std::size_t earlier = 0, later = 0;  ///< indices of the odometry's poses
  SE3 earlier_from_later;
  Matrix6d information = Matrix6d::Zero();  ///< as in Registration
};

/// Finds pairs of poses that are near each other by odometry, with a long path between them, and whose scans fit together. The
/// later scan is registered to a map of the earlier scans from initial guesses all over the place. It must fit nearly as well
/// as one of the earlier scans does, and so must a scan a little before it. Two views of a depth camera must also have similar
/// directions. `options` are adapted to the drive (adapt_to_sensor). Reads scans again; calls `tick` once per pose.
std::vector<Loop> find_loops(
    const Drive& drive, const OdometryOptions& options, const Odometry& odometry, const Tick& tick = [] {});

/// Finds loops and optimizes the odometry's poses in a pose graph with them (pose_graph.h). The first pose stays fixed. Without
/// loops, nothing changes. Calls `tick` once per pose.
void close_loops(const Drive& drive, const OdometryOptions& options, Odometry& odometry, const Tick& tick = [] {});

}  // namespace dvi::odometry
