#pragma once

#include <array>
#include <functional>
#include <vector>

#include "dvi/map/visible_points.h"

namespace dvi::depth {

/// Triangulates the image positions of the points (Delaunay) and calls `visit` with the three point indices of each triangle,
/// all in the same direction of rotation. Positions are rounded to 1/16 px, because the triangulation is computed exactly, on
/// integers. Of points with the same rounded position, one is used. Without three points that are not on a line, there are no
/// triangles.
void triangulate(const std::vector<map::VisiblePoint>& points,
                 const std::function<void(const std::array<std::size_t, 3>&)>& visit);

}  // namespace dvi::depth
