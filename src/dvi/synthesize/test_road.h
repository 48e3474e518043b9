#pragma once

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::synthesize {

constexpr double kCameraHeightM = 1.6;

/// A view along x, at a height above level ground.
inline View looking_ahead(double x) {
  View view;
  view.camera = {320, 120, 250, 250, 159.5, 39.5, {}};
  view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  view.camera_from_world.t = -(view.camera_from_world.R * Eigen::Vector3d(x, 0, 0));
  return view;
}

/// Level ground around a path of 60 m.
inline map::StaticMap make_level_map() {
  map::StaticMap map;
  for (double x = -20; x < 60; x += 0.5)
    for (double y = -12; y < 12; y += 0.5) {
      map::MapPoint point;
      point.position = Eigen::Vector3d(x, y, -kCameraHeightM).cast<float>();
      point.normal = Eigen::Vector3f::UnitZ();
      map.points.push_back(point);
    }
  return map;
}

}  // namespace dvi::synthesize
