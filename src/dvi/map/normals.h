#pragma once

#include "dvi/map/static_map.h"

namespace dvi::map {

/// Gives each point the normal of the plane through its surroundings (the cube of 3 x 3 x 3 cells of 0.2 m round it), toward
/// the sensor that saw it first. Points without enough round them, or with no plane, keep none.
void add_normals(StaticMap& map);

}  // namespace dvi::map
