#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "dvi/drive/drive.h"

namespace dvi::ground {

/// Height of the ground by place: per square meter the mean of the lowest level at which scans of the whole drive have returns
/// again and again, interpolated between the squares. Single returns below it, as mirrors cause them, do not count.
class ScanGround {
 public:
  ScanGround(const Drive& drive, const Trajectory& world_from_lidar);

  /// Meters, world axes; between the squares round the place, or of the nearest within 2 m. None where there is none.
  std::optional<double> height(const Eigen::Vector2d& place) const;

 private:
  using Square = std::pair<int, int>;
  std::optional<double> nearest(int x, int y) const;

  std::map<Square, double> heights_;
};

}  // namespace dvi::ground
