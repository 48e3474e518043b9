#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"

namespace dvi {

/// The ranges of one scan's rays by direction: space well in front of their ends was free at that time. They are stored as
/// images of the nearest return in windows of several sizes, so that a query needs one lookup.
class FreeSpace {
 public:
  FreeSpace() = default;
  /// `pose_error_m` is the error across the ray of poses between scans that queries take into account.
  FreeSpace(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar, double pose_error_m);

  /// Returns false if the poses do not cover the scan or if it has no returns; everything is unknown then.
  bool valid() const { return !poses_.empty(); }
  /// Returns the position of the sensor in the middle of the scan.
  const Eigen::Vector3d& sensor() const { return sensor_; }

  /// Returns the angle in radians from one ray to the next above it.
  float rise() const { return rise_; }

  /// Returns whether a position in world axes lies above all rays of the scan.
  bool is_above(const Eigen::Vector3d& world) const;

  enum class Seen : std::uint8_t { unknown, hidden, hit, passed };
  /// Determines whether the scan shows a small object of radius `radius_m` in world axes. `passed` means that all rays within
  /// its radius and the pose error, and the next rays above and below, ended behind it.
  Seen judge(const Eigen::Vector3d& world, double radius_m) const;

  std::size_t bytes() const;

  static constexpr double kMaxRangeM = 80;      ///< in meters; beyond it, rays are too far apart
  static constexpr float kObjectDepthM = 0.2F;  ///< in meters: returns nearer to each other belong to one object

 private:
  static constexpr std::array<int, 5> kWindows{1, 2, 3, 5, 8};  // cells in each direction
  struct LidarFromWorld {
    Eigen::Matrix3f R;
    Eigen::Vector3f t;  // relative to sensor_
  };

  /// Returns a position in world axes in the axes of the sensor, at the time of the rays toward it.
  Eigen::Vector3f to_sensor(const Eigen::Vector3d& world) const;
  void place(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar);
  void erode(const cv::Mat1w& nearest);

  double pose_error_ = 0;
  Eigen::Vector3d sensor_ = Eigen::Vector3d::Zero();
  float reach_ = 0;                    // meters from sensor_; points beyond it are outside kMaxRangeM during the whole scan
  std::vector<LidarFromWorld> poses_;  // one per column, at the time of its rays
  float low_ = 0;                      // elevation of row 0
  float high_ = 0;                     // elevation of the highest ray
  float rise_ = 0;
  // Per window: the range to the nearest return around a direction (0: not between returns), and to the farthest one above and
  // below it, in steps of 2 mm.
  std::array<cv::Mat2w, kWindows.size()> ranges_;
};

}  // namespace dvi
