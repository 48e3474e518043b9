#pragma once

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::depth {

/// A view from the origin along the x axis.
inline View test_view() {
  View view;
  view.camera = {320, 200, 250, 250, 159.5, 99.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return view;
}

/// Puts all points into one tile, which completes the map.
inline void finish(map::StaticMap& map) {
  Eigen::AlignedBox3f bounds;
  for (const map::MapPoint& p : map.points) bounds.extend(p.position);
  map.tiles = {{bounds, 0, map.points.size()}};
}

/// Adds a point in world axes, in meters.
inline void add(map::StaticMap& map, double x, double y, double z) {
  map.points.push_back({Eigen::Vector3d(x, y, z).cast<float>(), 0, 1});
}

}  // namespace dvi::depth
