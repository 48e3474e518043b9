#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::depth {

struct DepthOptions {
  double splat_m = 0.07;
  double see_through = 0.05;
  bool split_edges = true;
  double max_slope = 10;
  int median_px = 3;
  double sky_gap_deg = 0.4;
  int mask_margin_px = 0;

  void describe(OptionTable& table) {
    table.section("depth");
    table.add("splat_m", splat_m, {0, 1}, "Radius within which a map point hides points behind it; 0: a pixel.");
    table.add("see_through", see_through, {0, 1}, "A point hides those farther by more than this part of its depth.");
    table.add("split_edges", split_edges, "Triangles between several surfaces are cut instead of bent.");
    table.add("max_slope", max_slope, {1, 1000}, "Depth over width from which on sparse returns are no surface.");
    table.add("median_px", median_px, {0, 5}, "Side of the median filter after interpolation: 0 (none), 3 or 5.");
    table.add(
        "mask_margin_px", mask_margin_px, {0, 50},
        "No pixel is copied from within this distance of a source frame's own mask; pixels near it rank lower in any case.");
    table.add("sky_gap_deg", sky_gap_deg, {0, 10}, "Pixels above all returns within this angle to either side are sky.");
  }
};

/// Depth of a view from the map (section 3.3 of the paper): the visible points with the planes they lie on, and between them
/// what those surfaces show: one surface interpolated linearly in 1/z (exact for planes), several cut where they meet or hide
/// each other. Pixels above the last return are sky.
DepthMap depth_map(const map::StaticMap& map, const View& view, const DepthOptions& options);

}  // namespace dvi::depth
