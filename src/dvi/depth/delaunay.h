#pragma once

#include <array>
#include <functional>
#include <vector>

#include "dvi/map/visible_points.h"

namespace dvi::depth {

/// Calls `triangle` with the indices of each triangle of the Delaunay triangulation of the points' pixels (dual of the
/// Voronoi diagram, exact at 1/16 px). Points must lie at different pixels.
void delaunay(const std::vector<map::VisiblePoint>& points,
              const std::function<void(const std::array<std::size_t, 3>&)>& triangle);

}  // namespace dvi::depth
