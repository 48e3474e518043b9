#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "dvi/drive/drive.h"
#include "dvi/drive/free_space.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// The visibility vote on a return. moving: other scans observed free space at its position. stationary: they observed a
/// surface there. unknown: they observed neither.
enum class VisibilityVote : std::uint8_t { unknown, stationary, moving };

/// The returns of one scan above the ground and below bridges and signs.
struct ObstacleReturns {
  std::vector<Eigen::Vector3d> points;  ///< meters, world axes
  std::vector<std::int64_t> time_ns;    ///< per point: time of the measurement
  std::vector<double> ground;           ///< per point: height of the ground below, meters, world axes
  std::vector<double> ray_spacing_m;    ///< per point: distance to the next ray above
  std::vector<VisibilityVote> vote;     ///< per point; empty without a comparison with other scans
  std::vector<std::uint32_t> label;     ///< per point: PointLabels::values; empty if the drive has none

  std::size_t bytes() const {
    return bytes_of(points) + bytes_of(time_ns) + bytes_of(ground) + bytes_of(ray_spacing_m) + bytes_of(vote) + bytes_of(label);
  }
};

/// The poses for comparisons of scans.
struct ScanPoses {
  Trajectory world_from_lidar;
  double error_m = 0.05;             ///< position error between two scans, across the ray
  std::vector<bool> untrusted = {};  ///< per scan, whether its pose is known to be wrong; empty if none is
};

struct ComparedScan;

/// Finds moving returns: compares each scan with those shortly before and after, and with some of the whole drive.
class MovingReturns {
 public:
  MovingReturns(const Drive& drive, const ScanPoses& poses, const ground::ScanGround& ground);
  MovingReturns(const MovingReturns&) = delete;
  MovingReturns& operator=(const MovingReturns&) = delete;

  std::size_t scans() const { return sensors_.size(); }
  /// Returns the time of the middle of a scan.
  std::int64_t time_ns(std::size_t scan) const { return drive_.scan_headers[scan].time_ns; }
  /// Returns the scan nearest to a time; nothing if it is farther than kMaxFrameToScanNs from that time.
  std::optional<std::size_t> find_scan(std::int64_t time_ns) const;
  /// Returns the obstacle returns of a scan without votes, or none if its pose is wrong.
  std::shared_ptr<const ObstacleReturns> obstacles(std::size_t scan) const;
  /// Returns the obstacle returns of the scans [first, last) with the visibility votes of the other scans. The votes on several
  /// scans at a time need less time, because scans nearby are compared with the same ones.
  std::vector<ObstacleReturns> vote(std::size_t first, std::size_t last) const;
  std::shared_ptr<const FreeSpace> free_space(std::size_t scan) const { return spaces_[scan]; }
  /// Returns whether a scan may be compared with others.
  bool is_trusted(std::size_t scan) const { return !untrusted_[scan]; }
  /// Excludes a scan from comparisons.
  void distrust(std::size_t scan) { untrusted_[scan] = true; }
  /// Returns whether a scan is usable and was taken close enough to a position (world axes) to observe it.
  bool can_observe(std::size_t scan, const Eigen::Vector2d& position) const;
  /// Returns a rectangle (world axes) that contains all positions for which can_observe() is true.
  Eigen::AlignedBox2d observable_area(std::size_t scan) const;

 private:
  ObstacleReturns extract_obstacles(std::size_t scan) const;
  ComparedScan list_comparisons(std::size_t scan) const;
  std::vector<std::size_t> select_window(std::size_t scan) const;
  std::vector<std::size_t> select_distant(std::size_t scan) const;

  const Drive& drive_;
  Trajectory world_from_lidar_;
  const ground::ScanGround& ground_;
  Lazy<FreeSpace> spaces_;                // per scan
  Lazy<ObstacleReturns> obstacles_;       // per scan
  std::vector<Eigen::Vector2d> sensors_;  // per scan: position, world axes
  std::vector<bool> untrusted_;           // per scan
};

}  // namespace dvi::objects
