#pragma once

#include "dvi/map/static_map.h"

namespace dvi::map {

/// Parameters of the normals of map points.
struct MapNormalParams {
  double cell_m = 0.2;               ///< edge of a cell; a neighborhood has 3 x 3 x 3 cells
  int min_points = 6;                ///< of a neighborhood
  float min_width_m = 0.08F;         ///< standard deviation; a strip narrower than four times the range noise has no normal
  float max_flatness = 0.25F;        ///< smallest variance of a plane over the middle one
  std::size_t tiles_in_memory = 32;  ///< of a map that is paged to disk
};
inline constexpr MapNormalParams kMapNormal;

/// Estimates for each point the normal of the plane through its neighborhood (3 x 3 x 3 cells of 0.2 m), oriented toward the
/// sensor that observed it first. The normal stays zero if the neighborhood has too few points or is not planar.
void add_normals(StaticMap& map);

}  // namespace dvi::map
