#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/geometry/se3.h"
#include "dvi/geometry/trajectory.h"

namespace dvi::holdout {

/// Parameters of the ground in the lane of the vehicle.
struct LaneGroundParams {
  float min_distance_m = 3;       ///< of a return, ahead or behind
  float max_distance_m = 30;      ///< likewise
  float half_width_m = 1.5F;      ///< of the lane
  float max_height_m = -0.3F;     ///< of a return, relative to the LiDAR
  float min_height_m = -5;        ///< likewise
  double bin_m = 0.1;             ///< of the histogram of heights
  double histogram_range_m = 15;  ///< returns within this distance give the initial height
  double max_residual_m = 0.15;   ///< of an inlier of the line
  double max_slope = 0.1;
  int min_inliers = 20;
  std::size_t smoothing_scans = 2;  ///< before and after, because the fits of single scans jitter
};
inline constexpr LaneGroundParams kLaneGround;

/// The path of a drive, with the ground around it as each of its scans shows it. Given poses drift relative to the ground by
/// more than a vehicle may float, so that heights come from the scans, not from the path.
class DrivenPath {
 public:
  /// Throws InputError if no scan shows any ground. Reads all scans once.
  DrivenPath(const Drive& drive, const Trajectory& world_from_lidar);

  /// Returns the path length in meters up to a time. Outside the poses, the time of the nearest pose is used.
  double path_length_at(std::int64_t time_ns) const;
  double length() const { return meters_.back(); }
  /// Returns the median height of the LiDAR above the ground in meters.
  double sensor_height() const { return sensor_height_; }

  /// Returns world_from_road of a position on the ground: meters along the path (the path continues beyond its ends with the
  /// last curvature) and meters to its left. Axes: x ahead, y left, z up. The height is that of the ground at `time_ns`.
  SE3 road_pose(double along, double left, std::int64_t time_ns) const;

 private:
  // In LiDAR axes: z = -height + slope * distance ahead, in meters.
  struct GroundLine {
    double height = 0, slope = 0;
  };
  struct StampedGround {
    std::int64_t time_ns = 0;
    GroundLine ground;
  };

  void measure_ground(const Drive& drive);
  GroundLine ground_at(std::int64_t time_ns) const;
  Eigen::Vector3d tangent(double along) const;
  SE3 lidar_within(double along) const;
  SE3 lidar_at(double along) const;

  Trajectory world_from_lidar_;
  std::vector<double> meters_;  // one per pose
  Eigen::Vector3d ahead_;       // direction of the first pose, for a stationary drive
  double sensor_height_ = 0;
  std::vector<StampedGround> grounds_;  // in order of time
};

}  // namespace dvi::holdout
