#pragma once

#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::map {

/// A map point as a view sees it.
struct VisiblePoint {
  float u = 0, v = 0;                               ///< pixel, sub-pixel exact
  float z = 0;                                      ///< meters along the optical axis
  Eigen::Vector3f world = Eigen::Vector3f::Zero();  ///< meters
  std::size_t index = 0;                            ///< in StaticMap::points
};

/// The points of the map that the view sees, at most one a pixel: the nearest (z-buffer), if no nearer point, taken as a disc
/// of `splat_m` meters radius, covers it by more than `tolerance` of its depth. In raster order. Only
/// as far as a pixel spans half a meter, so that the cost of a view does not grow with the map.
std::vector<VisiblePoint> visible_points(const StaticMap& map, const View& view, double splat_m, double tolerance);

/// The map with what each view sees of it, for the stages that compare the colors of views at its points: projected once, on
/// demand, and shared.
struct VisibleMap {
  static constexpr double kSplat = 0.1;       ///< meters: poses are not refined yet
  static constexpr double kTolerance = 0.05;  ///< of depth

  VisibleMap(const StaticMap& of, const Views& views)  // NOLINT(google-explicit-constructor): {map, views} as an argument
      : map(of), points(views.size(), [&of, list = views.views](std::size_t i) {
          return visible_points(of, list[i], kSplat, kTolerance);
        }) {}

  const StaticMap& map;
  Lazy<std::vector<VisiblePoint>> points;  ///< as the views
};

}  // namespace dvi::map
