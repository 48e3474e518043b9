#pragma once

#include <vector>

#include "dvi/core/options.h"
#include "dvi/depth/target.h"
#include "dvi/sample/candidates.h"

namespace dvi::sample {

/// Options of sample() and sample_known(); describe() documents each field.
struct SampleOptions {
  bool occlusion_test = true;
  double occlusion_tolerance = 0.05;
  int max_frame_gap = 120;
  bool scored = true;
  int sources = 3;
  double max_error_px = 1.7;
  bool footprint = true;

  void describe(OptionTable& table) {
    table.section("sample");
    table.add("max_frame_gap", max_frame_gap, {0, 1000000},
              "Source frames: up to this many before and after, twice as many of each source drive; 0: all.");
    table.developer();
    table.add("occlusion_test", occlusion_test,
              "Reject source frames that show a surface in front of or behind that of the pixel.");
    table.add("occlusion_tolerance", occlusion_tolerance, {0, 1},
              "Part of the depth by which two depths of one surface may differ beyond their uncertainty.");
    table.add("scored", scored,
              "Rank source frames by score; false: the first that fits, forward, then backward, as published.");
    table.add("sources", sources, {1, 8}, "Maximum number of sources per pixel; those that agree are averaged.");
    table.add("max_error_px", max_error_px, {0.1, 1000},
              "Maximum expected error of a copy, from displacement and blur; other sources are not used.");
    table.add("footprint", footprint, "Average the source pixels that one target pixel covers.");
  }
};

/// Finds candidates for each hole pixel of the target in other frames (section 3.2 of the paper). The pixel's point, given by
/// its depth, is projected into the frames near the target in time, then into source drives. A frame is a candidate if the
/// projection is inside its image, outside its mask, and shows the same surface. Up to `sources` candidates are kept, by
/// decreasing score_source().
Candidates sample(const depth::Target& target, const SampleOptions& options);

/// Finds candidates for known pixels around the hole of the target, by which the errors of copies are measured. Each is
/// projected into the frames of the target's drive that are candidates of the nearest pixel of `hole`.
Candidates sample_known(const depth::Target& target, const Candidates& hole, const SampleOptions& options);

/// Lists the views that sample() searches, in this order: by increasing distance in time, or if not `scored`, forward, then
/// backward, as published; then source drives by distance. Views that do not share the target's colors are excluded, because
/// gray and color images are not mixed.
std::vector<std::size_t> list_search_order(const Views& views, std::size_t target, const SampleOptions& options);

}  // namespace dvi::sample
