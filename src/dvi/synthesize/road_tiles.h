#pragma once

#include <optional>
#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"
#include "dvi/ground/road_frame.h"
#include "dvi/ground/road_ground.h"
#include "dvi/synthesize/texture_tile.h"

namespace dvi::synthesize {

/// The views of the target's sequence by their position along the road, in meters.
struct RoadViews {
  const Views* views;
  Lazy<depth::VisibilityMap> visibility;
  std::vector<double> along_m;  ///< One per view of the target's sequence; far away for views that are not on the road.

  RoadViews(const Views& all, const Lazy<depth::VisibilityMap>& visibility_maps, const ground::RoadFrame& road);
  /// Lists views between two positions along the road, by increasing distance to `preferred`.
  std::vector<std::size_t> list_between(double first, double last, double preferred) const;
};

/// The texture of the ground, in tiles along the road that are computed on demand. Columns are along the road, rows go to the
/// left.
struct RoadTiles {
  static constexpr double kCellM = 0.05;     ///< Side of a cell.
  static constexpr double kTileM = 8;        ///< Length of a tile along the road.
  static constexpr double kHalfWidthM = 12;  ///< Extent to both sides of the road's axis.
  Lazy<TextureTile> tiles;

  RoadTiles(const RoadViews& views, const ground::RoadGround& ground);
};

}  // namespace dvi::synthesize
