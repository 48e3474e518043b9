#pragma once

#include <vector>

#include "dvi/geometry/se3.h"
#include "dvi/scan_match/features.h"
#include "dvi/scan_match/local_map.h"

namespace dvi::scan_match {

/// The scene around the vehicle, with planes in voxels of two sizes. The small ones are used if they have enough points.
struct LocalMaps {
  LocalMap fine, coarse, edges;

  void add(const Features& features, const SE3& world_from_lidar, const Vector6d& twist);
  void remove(const Features& features, const SE3& world_from_lidar, const Vector6d& twist);
  void keep_near(const Eigen::Vector3d& position, double radius_m);
};

/// Compensates a feature for the LiDAR's motion relative to the middle of the scan: a constant twist per second in the LiDAR's
/// axes at the middle.
Eigen::Vector3d compensate(const Feature& feature, const Vector6d& twist);

/// The options of register_scan().
struct RegisterOptions {
  int iterations = 20;
  int coarse_iterations = 0;  ///< the first of these iterations use large voxels only
  double noise_m = 0.03;      ///< noise of a return across a surface
  double kernel_m = 0.1;      ///< scale of the robust kernel; much larger residuals have no weight
  double prior_m =
      0.1;  ///< standard deviation of the guess (one tenth of it in radians), for directions that the scene does not constrain
  bool keeps_guess = false;  ///< the guess is measured: directions that the scene does not constrain keep it
};

/// The result of a registration.
struct Registration {
  SE3 world_from_lidar;
  Vector6d twist = Vector6d::Zero();
  double residual_m = 0;  ///< RMS distance of the inliers from their surfaces
  std::size_t inliers = 0, features = 0;
  int degenerate = 0;                       ///< number of directions that the scene does not constrain
  Matrix6d information = Matrix6d::Zero();  ///< of the pose including the prior: translation, rotation, in the LiDAR's axes
};

/// The guess of a scan's pose, and the LiDAR's motion within the scan: the given twist or, if `seconds` is above 0, the motion
/// from the pose `before`, so many seconds earlier.
struct ScanGuess {
  SE3 world_from_lidar;
  Vector6d twist = Vector6d::Zero();  ///< per second, in the LiDAR's axes
  SE3 before = {};
  double seconds = 0;
};

/// Registers a scan to the scene: Gauss-Newton on SE(3) over distances to planes and lines (Geman-McClure weights). If its
/// motion follows from a pose before it, the scan is compensated again in each iteration.
Registration register_scan(const Features& features, const ScanGuess& guess, LocalMaps& scene, const RegisterOptions& options);

/// Computes the share of the features of a registered scan on the scene, 0 to 1, within `on_m` of it. Features on level ground
/// are ignored, because it looks the same everywhere. The scene's z axis points up.
double compute_scene_share(const Features& features, const Registration& registration, LocalMaps& scene, double on_m = 0.15);

}  // namespace dvi::scan_match
