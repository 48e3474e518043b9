#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "dvi/diagnostics/flow_pairs.h"
#include "dvi/geometry/camera.h"

namespace dvi::diagnostics {

/// How the camera may differ from what is given: radians about its own axes (right, down, forward), and seconds by which the
/// times of its images are late.
using CameraError = Eigen::Vector4d;
using FreeParts = std::array<bool, 4>;

/// Holds the flow of pairs of images against the flow that the LiDAR's returns and motion predict, if the camera were such and
/// mounted so.
class CameraFit {
 public:
  /// `pairs` outlive it. `camera` is of their size.
  CameraFit(const FlowPairs& pairs, const Camera& camera, const SE3& camera_from_lidar);

  /// A pair: from 0, all returns move as predicted, to 1, none do. NaN where the LiDAR's motion is not known then.
  std::vector<double> costs(const CameraError& error) const;
  /// The mean of costs(); 1 where fewer than half are known.
  double cost(const CameraError& error) const;
  /// The error that explains the flow best near `start`, by its free parts, without pair `leave_out`: Gauss-Newton, with
  /// Geman-McClure weights.
  CameraError refined(const CameraError& start, const FreeParts& free, std::size_t leave_out = SIZE_MAX) const;

  /// Median over pairs of the share of returns that lie in the image.
  double share_in_sight() const;

 private:
  const FlowPairs& pairs_;
  Camera camera_;
  SE3 camera_from_lidar_;
  std::vector<std::vector<Eigen::Vector3d>> near_;  // a pair: returns in the image or near it
};

}  // namespace dvi::diagnostics
