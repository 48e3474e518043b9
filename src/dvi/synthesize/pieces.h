#pragma once

#include <optional>
#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"
#include "dvi/ground/road_frame.h"
#include "dvi/ground/road_ground.h"
#include "dvi/synthesize/sheet.h"

namespace dvi::synthesize {

/// Colors that views show of points of the world, in common light.
struct Painter {
  const Views* views;
  Lazy<depth::VisibilityMap> visibility;
  std::vector<double> along;  ///< of each view of the target's sequence: where on the road its camera is

  Painter(const Views& of, const Lazy<depth::VisibilityMap>& seen, const ground::RoadFrame& road);
  /// The views between two places of the road, by falling nearness to a place.
  std::vector<std::size_t> between(double first, double last, double nearest_to) const;
};

/// The ground, in pieces along the road. A cell is kCell meters wide; rows go to the left.
struct GroundSheets {
  static constexpr double kCell = 0.05, kPiece = 8;  ///< meters
  static constexpr double kWide = 12;                ///< meters to either side
  Lazy<Sheet> pieces;

  GroundSheets(const Painter& painter, const ground::RoadGround& ground);
};

}  // namespace dvi::synthesize
