#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/free_space.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// What other scans say of a return: they saw through its place, saw something there, or cannot tell.
enum class Witness : std::uint8_t { unknown, standing, moving };

/// The returns of one scan that lie above the ground, below bridges and signs.
struct ObstacleReturns {
  std::vector<Eigen::Vector3d> points;  ///< meters, world axes
  std::vector<std::int64_t> time_ns;    ///< as `points`: when each was measured
  std::vector<double> ground;           ///< as `points`: height of the ground below, world axes
  std::vector<double> rise;             ///< as `points`: meters to the next ray above
  std::vector<Witness> witness;         ///< as `points`; empty where nobody asked

  std::size_t bytes() const {
    return bytes_of(points) + bytes_of(time_ns) + bytes_of(ground) + bytes_of(rise) + bytes_of(witness);
  }
};

/// The poses that scans are compared by.
struct ScanPoses {
  Trajectory world_from_lidar;
  double error_m = 0.05;             ///< Error of a position between two scans, across the ray.
  std::vector<bool> untrusted = {};  ///< For each scan, whether its pose is known to be wrong; empty if none is.
};

class Votes;

/// Compares each scan with others: those shortly before and after, and some of the whole drive.
class MovingReturns {
 public:
  MovingReturns(const Drive& drive, const ScanPoses& poses, const ground::ScanGround& ground);
  MovingReturns(const MovingReturns&) = delete;
  MovingReturns& operator=(const MovingReturns&) = delete;

  std::size_t scans() const { return sensors_.size(); }
  /// The obstacle returns of a scan; none if the scan is not trusted.
  std::shared_ptr<const ObstacleReturns> obstacles(std::size_t scan) const;
  /// The same returns with the votes of the other scans.
  ObstacleReturns find(std::size_t scan) const;
  std::shared_ptr<const FreeSpace> free_space(std::size_t scan) const { return spaces_[scan]; }

  /// Whether a scan may be compared with others.
  bool trusts(std::size_t scan) const { return !untrusted_[scan]; }
  void distrust(std::size_t scan) { untrusted_[scan] = true; }
  /// Whether a scan was taken near enough to a place to observe it.
  bool observes(std::size_t scan, const Eigen::Vector2d& place) const;

 private:
  ObstacleReturns obstacles_of(std::size_t scan) const;
  std::vector<Votes> votes_of(const std::vector<std::size_t>& scans, std::size_t judged,
                              const std::vector<Eigen::Vector3d>& points) const;
  std::vector<std::size_t> witnesses_far(std::size_t scan) const;

  const Drive& drive_;
  Trajectory world_from_lidar_;
  const ground::ScanGround& ground_;
  Lazy<FreeSpace> spaces_;                // as the scans
  Lazy<ObstacleReturns> obstacles_;       // as the scans
  std::vector<Eigen::Vector2d> sensors_;  // as the scans
  std::vector<bool> untrusted_;           // as the scans
};

}  // namespace dvi::objects
