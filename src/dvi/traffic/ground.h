#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "dvi/drive/drive.h"

namespace dvi::traffic {

/// Height of the ground by place: per square metre the lowest level at which scans of the whole drive have returns again and
/// again. Single returns below it, as mirrors cause them, do not count.
class Ground {
 public:
  Ground(const Drive& drive, const Trajectory& world_from_lidar);

  /// Metres, world axes; of the nearest square within 2 m that has one.
  std::optional<double> height(const Eigen::Vector3d& place) const;

 private:
  using Square = std::pair<int, int>;
  std::map<Square, double> heights_;
};

}  // namespace dvi::traffic
