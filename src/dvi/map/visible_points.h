#pragma once

#include <vector>

#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::map {

/// A map point in a view.
struct VisiblePoint {
  float u = 0, v = 0;                               ///< image coordinates with sub-pixel precision
  float z = 0;                                      ///< Camera::depth() in meters
  Eigen::Vector3f world = Eigen::Vector3f::Zero();  ///< meters
  std::size_t index = 0;                            ///< in StaticMap::points
};

/// Finds the points of the map that are visible in the view, at most one per pixel (z-buffer), in raster order. A point is
/// hidden if a nearer point, as a disc with a radius of `splat_m`, covers it and is nearer by more than `tolerance` of its
/// depth. Ends at the depth at which a pixel spans half a meter, so that the cost of a view does not grow with the map.
std::vector<VisiblePoint> find_visible_points(const StaticMap& map, const View& view, double splat_m, double tolerance);

/// The map with the visible points of each view, for the stages that compare the colors of views at map points. Each view is
/// projected once, on demand, and the result is shared.
struct VisibleMap {
  static constexpr double kSplatM = 0.1;      ///< larger than a voxel, because poses are not refined yet
  static constexpr double kTolerance = 0.05;  ///< relative difference in depth

  VisibleMap(const StaticMap& of, const Views& views)  // NOLINT(google-explicit-constructor): {map, views} as an argument
      : map(of), points(views.size(), [&of, list = views.views](std::size_t i) {
          return find_visible_points(of, list[i], kSplatM, kTolerance);
        }) {}

  const StaticMap& map;
  Lazy<std::vector<VisiblePoint>> points;  ///< one list per view
};

}  // namespace dvi::map
