#pragma once

#include <array>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"

namespace dvi {

/// How far the rays of one scan went, by direction: what lies well before their ends was free then. Kept as images of the
/// nearest return in windows of several sizes, so that a question costs one look.
class FreeSpace {
 public:
  FreeSpace() = default;
  /// Answers hold for poses, between scans, that are right to `pose_error_m` across the ray.
  FreeSpace(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar, double pose_error_m);

  /// False where the poses do not cover the scan or it has no returns: then everything is unknown.
  bool valid() const { return !poses_.empty(); }
  /// Where the sensor was in the middle of the scan.
  const Eigen::Vector3d& sensor() const { return sensor_; }

  /// Radians from one ray to the next above it.
  float rise() const { return rise_; }

  enum class Seen { unknown, hidden, hit, passed };
  /// What the scan saw of a small thing of radius `radius_m` in world axes. `passed`: every ray within its radius and the
  /// pose error, and the next rays above and below, went on behind it.
  Seen judge(const Eigen::Vector3d& world, double radius_m) const;

  std::size_t bytes() const;

  static constexpr double kMaxRange = 80;  ///< meters; beyond, rays are too far apart to tell
  static constexpr float kDepth = 0.2F;    ///< meters: returns nearer together are of one thing

 private:
  static constexpr std::array<int, 5> kWindows{1, 2, 3, 5, 8};  // cells each way
  struct LidarFromWorld {
    Eigen::Matrix3f R;
    Eigen::Vector3f t;  // of the world moved to sensor_
  };

  void place(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar);
  void erode(const cv::Mat1f& nearest);

  double pose_error_ = 0;
  Eigen::Vector3d sensor_ = Eigen::Vector3d::Zero();
  float reach_ = 0;                    // meters from sensor_; nothing farther is within kMaxRange at any time of the scan
  std::vector<LidarFromWorld> poses_;  // one a column: when it was swept
  float low_ = 0;                      // elevation of row 0
  float rise_ = 0;
  // The nearest return round a direction, 0: not between returns; and the farthest above and below it.
  std::array<cv::Mat1f, kWindows.size()> nearest_, farthest_;
};

}  // namespace dvi
