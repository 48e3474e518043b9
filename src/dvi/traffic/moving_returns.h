#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dvi/drive/drive.h"
#include "dvi/drive/free_space.h"
#include "dvi/traffic/ground.h"

namespace dvi::traffic {

/// What other scans say of a return: they saw through its place, saw something there, or cannot tell.
enum class Witness : std::uint8_t { unknown, standing, moving };

/// The returns of one scan that lie above the ground, below bridges and signs.
struct ObstacleReturns {
  std::vector<Eigen::Vector3d> points;  ///< metres, world axes
  std::vector<std::int64_t> time_ns;    ///< as `points`: when each was measured
  std::vector<double> ground;           ///< as `points`: height of the ground below, world axes
  std::vector<double> rise;             ///< as `points`: metres to the next ray above
  std::vector<Witness> witness;         ///< as `points`; empty where nobody asked
};

/// Compares each scan with others: those shortly before and after, and some of the whole drive, so that what stood for long
/// and then left is told as well.
class MovingReturns {
 public:
  MovingReturns(const Drive& drive, const Trajectory& world_from_lidar, const Ground& ground, double pose_error_m);

  std::size_t scans() const { return sensors_.size(); }
  ObstacleReturns obstacles(std::size_t scan) const;
  ObstacleReturns find(std::size_t scan) const;  ///< the same, with their witnesses
  std::shared_ptr<const FreeSpace> free_space(std::size_t scan) const { return spaces_[scan]; }

 private:
  std::vector<std::size_t> witnesses_far(std::size_t scan) const;

  const Drive& drive_;
  Trajectory world_from_lidar_;
  const Ground& ground_;
  Lazy<FreeSpace> spaces_;                // as the scans
  std::vector<Eigen::Vector2d> sensors_;  // as the scans
};

}  // namespace dvi::traffic
