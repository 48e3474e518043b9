#pragma once

#include <optional>
#include <vector>

#include "dvi/ground/road_frame.h"
#include "dvi/map/static_map.h"

namespace dvi::ground {

/// Parameters of the ground along the road.
struct RoadGroundParams {
  double square_m = 2;           ///< edge of the squares with one height each
  double lane_half_width_m = 2;  ///< distance from the path within which there is only road
  double min_normal_z = 0.9;     ///< of a level surface
  double min_camera_m = 0.3;     ///< height of a camera above the ground
  double max_camera_m = 4;       ///< likewise
  double max_curb_m = 0.35;      ///< height difference beside the lane ...
  double max_slope = 0.06;       ///< ... plus this share of the distance from the path
  int min_points = 3;            ///< of a square
};
inline constexpr RoadGroundParams kRoadGround;

/// The height of the ground along the road of the target, from the level surfaces of the map.
class RoadGround {
 public:
  RoadGround(const map::StaticMap& map, const Views& views);

  /// Returns whether there is ground: level surfaces below the cameras.
  bool found() const { return !lane_.empty(); }
  const RoadFrame& road() const { return road_; }
  /// Returns the height in meters, in the world.
  double height(double along, double left) const;
  /// Returns the height at a position in the world; nothing if it is too far from the road.
  std::optional<double> height(const Eigen::Vector2d& position) const;

 private:
  double square_height(int along, int left) const;

  RoadFrame road_;
  std::vector<float> lane_;    // per square along the path
  std::vector<float> beside_;  // relative to lane_, one row of squares per square along the path
};

}  // namespace dvi::ground
