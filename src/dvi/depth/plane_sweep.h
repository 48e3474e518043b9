#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/target.h"

namespace dvi::depth {

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
    table.add("sources", sources, {2, 16}, "Most views that are compared.");
    table.add("max_frame_gap", max_frame_gap, {1, 1000}, "Views are taken from up to this many frames before and after.");
  }
};

/// Depth for the pixels of the target's hole, and within 12 px of it, that have none although a surface below them or the sky
/// does: the one at which the views that show them agree (plane sweep over inverse depth; Collins, 1996), infinity where
/// nothing moves between them.
/// The depth is kept where they do not agree, or agree because nothing is to be seen there.
DepthMap plane_sweep(const Target& target, const PlaneSweepOptions& options);

}  // namespace dvi::depth
