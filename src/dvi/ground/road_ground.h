#pragma once

#include <optional>
#include <vector>

#include "dvi/ground/road_frame.h"
#include "dvi/map/static_map.h"

namespace dvi::ground {

/// Height of the ground along the target's road, from the map's level surfaces.
class RoadGround {
 public:
  RoadGround(const map::StaticMap& map, const Views& views);

  /// Whether there is any: level surfaces below the cameras.
  bool found() const { return !lane_.empty(); }
  const RoadFrame& road() const { return road_; }
  /// Meters, world axes.
  double height(double along, double left) const;
  /// The same below or above a place of the world; none beyond the road's reach.
  std::optional<double> height(const Eigen::Vector2d& place) const;

 private:
  double square(int along, int left) const;

  RoadFrame road_;
  std::vector<float> lane_;    // by kSquare of the way
  std::vector<float> beside_;  // relative to it, kAcross a square of the way
};

}  // namespace dvi::ground
