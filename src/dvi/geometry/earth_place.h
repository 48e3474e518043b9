#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "dvi/geometry/trajectory.h"

namespace dvi {

/// Where a GPS antenna was (WGS84).
struct GeoFix {
  std::int64_t time_ns = 0;
  double latitude_deg = 0, longitude_deg = 0;
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  ///< meters, in the axes of the body whose trajectory is sought
};

/// Where a world, z up, lies on Earth (WGS84).
struct EarthPlace {
  double latitude_deg = 0, longitude_deg = 0;  ///< of its origin
  double heading_deg = 0;                      ///< of its x axis, clockwise from north
};

/// A place that was found, and how well the fixes agree with it.
struct FoundPlace {
  EarthPlace place;
  std::size_t fixes = 0;
  double residual_m = 0;         ///< half of the fixes are nearer to the path
  double heading_bound_deg = 0;  ///< by fixes at both ends of the path that are wrong by twice that
};

/// Lays a path onto its fixes: origin and heading by robust least squares, horizontally. None where fewer than three have a
/// pose, or the path is so short that the heading would be uncertain by more than 5 degrees.
std::optional<FoundPlace> find_place(const Trajectory& world_from_body, const std::vector<GeoFix>& fixes);

}  // namespace dvi
