#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "dvi/odometry/odometry.h"
#include "dvi/odometry/rgbd_image.h"
#include "dvi/scan_match/pose_graph.h"

namespace dvi::odometry {

/// The pose of an image relative to a key frame.
struct RgbdPose {
  std::optional<std::size_t> key;  ///< the key frame that it was aligned to; none if the track was lost
  SE3 key_from_camera;
  Matrix6d information = Matrix6d::Zero();  ///< inverse covariance of `key_from_camera`, in camera axes
  Vector6d twist = Vector6d::Zero();        ///< per second, in camera axes
  Vector6d depth_twist = Vector6d::Zero();  ///< the velocity with which the depth was moved to the time of the color image
  double overlap = 0;                       ///< the share of the key frame that the image shows
  std::size_t points = 0, inliers = 0;
  double residual_m = 0;
};

/// The result of tracking: moments with their poses relative to key frames, and motions measured between key frames.
struct RgbdTrack {
  std::vector<RgbdMoment> moments;
  std::vector<RgbdPose> poses;  ///< one per moment
  std::vector<SE3> world_from_key;
  std::vector<std::size_t> map_of_key;
  std::vector<scan_match::PoseEdge> edges;  ///< between key frames; those marked doubtful are loops
};

/// Optimizes the poses of the key frames of the largest map by the edges between them, and places all images of that map.
/// The trajectory has poses at the times of depth and of color images.
Odometry to_odometry(const Drive& drive, RgbdTrack track);

/// Makes a trajectory without poses at these times, which are in increasing order: it neither interpolates over a gap that
/// contains one of them nor extrapolates to them.
Trajectory exclude_times(std::vector<StampedPose> poses, const std::vector<std::int64_t>& lost_ns);

}  // namespace dvi::odometry
