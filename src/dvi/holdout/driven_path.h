#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/geometry/se3.h"
#include "dvi/geometry/trajectory.h"

namespace dvi::holdout {

/// The way a drive went, and the ground round it as each of its scans saw it. Given poses climb and sink against the ground by
/// more than wheels may float, so that heights come from the scans of the time, not from the path.
class DrivenPath {
 public:
  /// InputError where no scan shows any ground. Reads all scans once.
  DrivenPath(const Drive& drive, const Trajectory& world_from_lidar);

  /// Meters driven up to a time. Times outside the poses are those of the nearest.
  double along(std::int64_t time_ns) const;
  double length() const { return meters_.back(); }
  /// Meters of the LiDAR above the ground, in the median.
  double sensor_height() const { return sensor_height_; }

  /// A place on the ground as it lies to the LiDAR at a time: meters along the path (beyond its ends the last bend goes on) and
  /// to its left. Axes: x ahead, y left, z up.
  SE3 at(double along, double left, std::int64_t time_ns) const;

 private:
  // In LiDAR axes: z = -height + slope * meters ahead.
  struct Ground {
    double height = 0, slope = 0;
  };
  struct StampedGround {
    std::int64_t time_ns = 0;
    Ground ground;
  };

  void measure_ground(const Drive& drive);
  Ground ground_at(std::int64_t time_ns) const;
  Eigen::Vector3d tangent(double along) const;
  SE3 lidar_within(double along) const;
  SE3 lidar_at(double along) const;

  Trajectory world_from_lidar_;
  std::vector<double> meters_;  // one a pose
  Eigen::Vector3d ahead_;       // of the first pose, for a drive that stands
  double sensor_height_ = 0;
  std::vector<StampedGround> grounds_;  // in order of time
};

}  // namespace dvi::holdout
