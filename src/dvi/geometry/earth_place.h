#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dvi/geometry/trajectory.h"

namespace dvi {

/// The position of a GPS antenna (WGS84) at a time.
struct GeoFix {
  std::int64_t time_ns = 0;
  double latitude_deg = 0, longitude_deg = 0;
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  ///< in meters, in the axes of the body whose trajectory is aligned
};

/// The position and heading on Earth (WGS84) of a world whose z axis points up.
struct EarthPlace {
  double latitude_deg = 0, longitude_deg = 0;  ///< of its origin
  double heading_deg = 0;                      ///< of its x axis, clockwise from north
};

/// An estimated place and its agreement with the fixes.
struct FoundPlace {
  EarthPlace place;
  std::size_t fixes = 0;
  double residual_m = 0;         ///< median distance of the fixes from the path
  double heading_bound_deg = 0;  ///< heading error if the fixes at both ends of the path are off by twice the residual
};

/// Aligns a path with its fixes: estimates origin and heading by robust least squares in the horizontal plane. Returns nothing
/// if fewer than three fixes have a pose, or if the path is so short that the heading would be uncertain by more than 5
/// degrees.
std::optional<FoundPlace> find_place(const Trajectory& world_from_body, const std::vector<GeoFix>& fixes);

}  // namespace dvi
