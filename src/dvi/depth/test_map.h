#pragma once

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::depth {

/// Looks along x.
inline View test_view() {
  View view;
  view.camera = {320, 200, 250, 250, 159.5, 99.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return view;
}

/// One tile of all points.
inline void finish(map::StaticMap& map) {
  Eigen::AlignedBox3f bounds;
  for (const map::MapPoint& p : map.points) bounds.extend(p.position);
  map.tiles = {{bounds, 0, map.points.size()}};
}

inline void add(map::StaticMap& map, double x, double y, double z) {
  map.points.push_back({Eigen::Vector3d(x, y, z).cast<float>(), 0, 1});
}

}  // namespace dvi::depth
