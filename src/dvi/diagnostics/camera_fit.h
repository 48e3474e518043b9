#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "dvi/diagnostics/flow_pairs.h"
#include "dvi/geometry/camera.h"

namespace dvi::diagnostics {

/// Parameters of the fit.
struct CameraFitParams {
  double min_depth_m = 0.1;
  std::size_t max_returns = 1500;  ///< of a pair
  std::size_t min_returns = 100;   ///< of a pair, with flow; a pair with fewer has the cost 1
  double border_widths = 0.2;      ///< image widths around the image; returns there may enter it by a rotation
  double flow_error_px = 0.5;      ///< error of the optical flow
  double depth_error_share = 0.1;  ///< relative error of the predicted flow
  int max_iterations = 25;
};
inline constexpr CameraFitParams kCameraFit;

/// The error of a given camera: rotation in radians about its own axes (right, down, forward), and the delay of its images in
/// seconds.
using CameraError = Eigen::Vector4d;
/// The parts of the error that are estimated.
using FreeParts = std::array<bool, 4>;

/// Compares the optical flow of pairs of images with the flow that the LiDAR's returns and motion predict for a camera and its
/// mounting.
class CameraFit {
 public:
  /// `pairs` must outlive this object. `camera` has the size of their flow.
  CameraFit(const FlowPairs& pairs, const Camera& camera, const SE3& camera_from_lidar);

  /// Returns one cost per pair: from 0, if all returns move as predicted, to 1, if none do. NaN if the LiDAR's motion is
  /// unknown at that time.
  std::vector<double> costs(const CameraError& error) const;
  /// Returns the mean of costs(); 1 if fewer than half are known.
  double cost(const CameraError& error) const;
  /// Returns the error near `start` that explains the flow best, without pair `leave_out`. Only the free parts change.
  /// Gauss-Newton with Geman-McClure weights.
  CameraError refine(const CameraError& start, const FreeParts& free, std::size_t leave_out = SIZE_MAX) const;

  /// Returns the share of returns that are within the image: the median over the pairs.
  double compute_visible_share() const;

 private:
  const FlowPairs& pairs_;
  Camera camera_;
  SE3 camera_from_lidar_;
  std::vector<std::vector<Eigen::Vector3d>> near_;  // per pair: returns in or near the image
};

}  // namespace dvi::diagnostics
