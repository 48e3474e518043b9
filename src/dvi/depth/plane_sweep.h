#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/target.h"

namespace dvi::depth {

/// Options of sweep_planes(); describe() documents each field.
struct PlaneSweepOptions {
  bool enabled = true;
  int sources = 8;
  int max_frame_gap = 40;

  void describe(OptionTable& table) {
    table.section("stages");
    table.developer();
    table.add("plane_sweep", enabled, "Estimate depth inside holes where the map has none, from several views.");
    table.section("plane_sweep");
    table.developer();
    table.add("sources", sources, {2, 16}, "Maximum number of views that are compared.");
    table.add("max_frame_gap", max_frame_gap, {1, 1000}, "Views are taken from up to this many frames before and after.");
  }
};

/// Estimates the depth of pixels of the target's hole, and within 12 px of it, that have none although there is a surface or
/// the sky below or around them. The method is a plane sweep over inverse depth (R. Collins, CVPR 1996): it selects the depth
/// at which several views agree. Pixels without parallax are at infinity. The depth remains as it is where views do not agree,
/// or have too little texture to distinguish depths. Returns the completed depth map.
DepthMap sweep_planes(const Target& target, const PlaneSweepOptions& options);

}  // namespace dvi::depth
