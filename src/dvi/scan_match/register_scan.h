#pragma once

#include <vector>

#include "dvi/geometry/se3.h"
#include "dvi/scan_match/features.h"
#include "dvi/scan_match/local_map.h"

namespace dvi::scan_match {

/// The scene round the car, planes at two sizes of voxels: the small ones where they hold enough points.
struct LocalMaps {
  LocalMap fine, coarse, edges;

  void add(const Features& features, const SE3& world_from_lidar, const Vector6d& twist);
  void remove(const Features& features, const SE3& world_from_lidar, const Vector6d& twist);
  void keep_near(const Eigen::Vector3d& position, double radius_m);
};

/// The LiDAR's motion about the middle of a scan: constant twist, per second, in the LiDAR's axes at the middle.
Eigen::Vector3d compensated(const Feature& feature, const Vector6d& twist);

struct RegisterOptions {
  int iterations = 20;
  int coarse_iterations = 0;  ///< of them, first, on large voxels only
  double noise_m = 0.03;      ///< of a return, across a surface
  double kernel_m = 0.1;      ///< residuals well beyond count for nothing
  double prior_m = 0.1;       ///< how far off the guess may be where the scene tells nothing; a tenth of it in radians
  bool guess_holds = false;   ///< the guess is measured: directions that the scene does not hold stay as guessed
};

struct Registration {
  SE3 world_from_lidar;
  Vector6d twist = Vector6d::Zero();
  double residual_m = 0;  ///< RMS across surfaces, of the inliers
  std::size_t inliers = 0, features = 0;
  int degenerate = 0;                       ///< directions of motion that the scene does not hold
  Matrix6d information = Matrix6d::Zero();  ///< of the pose, prior included: translation, rotation, in the LiDAR's axes
};

/// Where a scan fits the scene: Gauss-Newton on SE(3) over distances to planes and lines (Geman-McClure weights). The motion
/// within the scan follows from the pose `seconds` before: the scan is compensated anew each iteration. With `seconds` 0 the
/// twist stays as given.
Registration register_scan(const Features& features, const SE3& guess, const Vector6d& twist, const SE3& before, double seconds,
                           LocalMaps& scene, const RegisterOptions& options);

/// Of the features that do not lie on level ground, which looks the same everywhere, the share that lies on what stands in the
/// scene, 0 to 1: within `on_m` of it. The scene's z points up.
double standing_share(const Features& features, const Vector6d& twist, const SE3& world_from_lidar, LocalMaps& scene,
                      double on_m = 0.15);

}  // namespace dvi::scan_match
