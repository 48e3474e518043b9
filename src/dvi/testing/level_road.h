#pragma once

#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"
#include "dvi/testing/memory_views.h"

namespace dvi {

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

/// A drive along a level road: twelve views, one per meter, and the map.
struct LevelRoad {
  static constexpr double kFocalPx = 250, kCenterX = 159.5, kHorizonY = 39.5;
  static constexpr int kColumns = 320, kRows = 120;
  std::vector<View> views;
  map::StaticMap map = make_level_map();

  LevelRoad() {
    for (int i = 0; i < 12; ++i) views.push_back(looking_ahead(i));
  }

  Views memory() const {
    return memory_views(views, std::vector<cv::Mat3b>(views.size()), std::vector<cv::Mat1b>(views.size()));
  }
  /// Returns how far a ray of an image row descends per meter ahead.
  static double descent(int row) { return (row - kHorizonY) / kFocalPx; }
};

}  // namespace dvi
