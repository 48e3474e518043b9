#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/diagnostics/scan_tracks.h"
#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Two images, how pixels moved from one to the other, and returns of the scan next to them.
struct FlowPair {
  std::int64_t from_ns = 0, to_ns = 0;   ///< of the images
  cv::Mat2f flow;                        ///< pixels of `FlowPairs::camera`; NaN where it cannot be relied on
  Trajectory world_from_lidar;           ///< by the scans
  std::vector<Eigen::Vector3d> returns;  ///< meters, world
};

struct FlowPairs {
  Camera camera;  ///< of the flow: the drive's, at half its size or less where the images are large
  std::vector<FlowPair> pairs;
};

/// At most a dozen pairs of images along the tracks, between which the drive moved far enough to tell near from far: few or
/// none where it stands. `masks`, as the drive's frames, leave pixels out; may be empty.
FlowPairs flow_pairs(const Drive& drive, const std::vector<ScanTrack>& tracks, const Lazy<cv::Mat1b>& masks);

}  // namespace dvi::diagnostics
