#pragma once

#include <array>
#include <functional>
#include <vector>

#include "dvi/map/visible_points.h"

namespace dvi::depth {

/// Triangulates the image positions of the points (Delaunay) and calls `visit` with the three point indices of each triangle.
/// Positions are rounded to 1/16 px, because the triangulation is computed exactly, as the dual of a Voronoi diagram on
/// integers. Two points must not share a rounded position.
void triangulate(const std::vector<map::VisiblePoint>& points,
                 const std::function<void(const std::array<std::size_t, 3>&)>& visit);

}  // namespace dvi::depth
