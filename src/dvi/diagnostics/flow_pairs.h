#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/diagnostics/scan_tracks.h"
#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Two images, the optical flow from one to the other, and the returns of the scan nearest in time.
struct FlowPair {
  std::int64_t from_ns = 0, to_ns = 0;   ///< of the images
  cv::Mat2f flow;                        ///< in pixels of `FlowPairs::camera`; NaN where it is unreliable
  Trajectory world_from_lidar;           ///< estimated from the scans
  std::vector<Eigen::Vector3d> returns;  ///< in the world, meters
};

struct FlowPairs {
  Camera camera;  ///< of the flow: the camera of the drive, at half its size or less if the images are large
  std::vector<FlowPair> pairs;
};

/// Parameters of the selection of pairs.
struct FlowPairParams {
  std::size_t max_pairs = 9;             ///< of all tracks
  double min_parallax_px = 4;            ///< of a return at the median range; well above the error of the flow
  std::size_t max_returns = 20000;       ///< of a scan
  int max_width_px = 1400;               ///< of the images between which flow is computed
  double max_return_error_px = 1;        ///< forward and backward flow may differ by this ...
  double max_return_error_share = 0.05;  ///< ... plus this share of the flow
};
inline constexpr FlowPairParams kFlowPair;

/// Computes the optical flow of at most nine pairs of images along the tracks. Between the images of a pair the drive moved far
/// enough for a parallax; a stationary drive has few pairs or none. `masks`, one per frame, exclude pixels; may be empty.
FlowPairs make_flow_pairs(const Drive& drive, const std::vector<ScanTrack>& tracks, const Lazy<cv::Mat1b>& masks);

}  // namespace dvi::diagnostics
