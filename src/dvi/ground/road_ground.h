#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dvi/geometry/se3.h"
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
  double max_surface_m = 0.35;   ///< height above the ground up to which a surface is ground; no curb is higher
  int min_points = 3;            ///< of a square
  double plane_ahead_m = 8;      ///< distance ahead of a camera at which its RoadPlane has the height of the ground
  double max_plane_m = 80;       ///< largest distance at which the ground is such a plane
  double max_lane_m = 150;       ///< largest distance at which a ray that meets this plane shows the lane
  double max_beyond_m = 70;      ///< distance before the first and after the last camera up to which the height is known
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

/// The level plane of the road ahead of a camera.
class RoadPlane {
 public:
  /// Returns the plane for a camera; nothing without ground, or if the camera is too far from the road.
  static std::optional<RoadPlane> below(const RoadGround& ground, const SE3& world_from_camera);

  /// Returns the horizontal displacement in meters from the camera to the point in which a ray (in the world) meets the plane;
  /// nothing above the horizon or too far away.
  std::optional<Eigen::Vector2d> meet(const Eigen::Vector3d& ray, double max_m = kRoadGround.max_plane_m) const;
  /// Returns whether a ray meets the plane in the lane, which is extended straight ahead. The camera drives along the lane, so
  /// that nothing stationary is there.
  bool is_in_lane(const Eigen::Vector3d& ray) const;
  /// Returns the height of the camera above the plane in meters.
  double below_m() const { return below_m_; }
  /// Returns the unit vector along the road at the camera.
  const Eigen::Vector2d& along() const { return along_; }

 private:
  explicit RoadPlane(const RoadFrame& road) : road_(&road) {}

  const RoadFrame* road_;
  Eigen::Vector2d camera_, along_;
  double below_m_ = 0;
};

}  // namespace dvi::ground
