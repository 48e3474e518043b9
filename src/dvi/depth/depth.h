#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/depth_map.h"
#include "dvi/drive/view.h"
#include "dvi/map/static_map.h"

namespace dvi::depth {

/// Options of compute_depth_map(); describe() documents each field.
struct DepthOptions {
  double splat_m = 0.07;
  double occlusion_tolerance = 0.05;
  bool split_edges = true;
  double max_slope = 10;
  int median_px = 3;
  double sky_gap_deg = 0.4;

  void describe(OptionTable& table) {
    table.section("depth");
    table.developer();
    table.add("splat_m", splat_m, {0, 1}, "Radius within which a map point occludes points behind it; 0: one pixel.");
    table.add("occlusion_tolerance", occlusion_tolerance, {0, 1},
              "A point occludes those that are farther by more than this part of its depth.");
    table.add("split_edges", split_edges, "Split triangles that span several surfaces instead of interpolating across them.");
    table.add("max_slope", max_slope, {1, 1000}, "Largest depth per width at which sparse returns still form a surface.");
    table.add_one_of("median_px", median_px, {0, 3, 5}, "Side of the median filter after interpolation; 0: none.");
    table.add("sky_gap_deg", sky_gap_deg, {0, 10}, "Pixels above all returns within this angle to either side are sky.");
  }
};

/// Computes the depth of every pixel of a view from the map (section 3.1 of the paper). The visible points are triangulated in
/// the image. A triangle on one surface is interpolated linearly in 1/z, which is exact for planes. A triangle that spans
/// several surfaces is split where these intersect or occlude each other. Pixels above the topmost return are sky.
DepthMap compute_depth_map(const map::StaticMap& map, const View& view, const DepthOptions& options);

}  // namespace dvi::depth
