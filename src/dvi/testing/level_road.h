#pragma once

#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"
#include "dvi/testing/memory_views.h"

namespace dvi {

/// A drive along a level road: twelve cameras, one per meter in direction x, and the map of the ground from 20 m behind the
/// first to 60 m ahead of it.
struct LevelRoad {
  static constexpr double kCameraHeightM = 1.6, kFocalPx = 250, kCenterX = 159.5, kHorizonY = 39.5;
  static constexpr int kColumns = 320, kRows = 120;
  std::vector<View> views;
  map::StaticMap map;

  LevelRoad() {
    for (int i = 0; i < 12; ++i) {
      View view;
      view.camera = {kColumns, kRows, kFocalPx, kFocalPx, kCenterX, kHorizonY, {}};
      view.camera_from_world.R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
      view.camera_from_world.t = -(view.camera_from_world.R * Eigen::Vector3d(i, 0, 0));
      views.push_back(view);
    }
    for (double x = -20; x < 60; x += 0.5)
      for (double y = -12; y < 12; y += 0.5) {
        map::MapPoint point;
        point.position = Eigen::Vector3d(x, y, -kCameraHeightM).cast<float>();
        point.normal = Eigen::Vector3f::UnitZ();
        map.points.push_back(point);
      }
  }

  Views memory() const {
    return memory_views(views, std::vector<cv::Mat3b>(views.size()), std::vector<cv::Mat1b>(views.size()));
  }
  /// Returns how far a ray of an image row descends per meter ahead.
  static double descent(int row) { return (row - kHorizonY) / kFocalPx; }
};

}  // namespace dvi
