#pragma once

#include <vector>

#include "dvi/core/options.h"
#include "dvi/depth/target.h"
#include "dvi/sample/candidates.h"

namespace dvi::sample {

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
    table.add("occlusion_test", occlusion_test, "Reject source frames that see another surface before or behind the pixel's.");
    table.add("occlusion_tolerance", occlusion_tolerance, {0, 1},
              "Part of the depth by which two depths of one surface may differ beyond their uncertainty.");
    table.add("scored", scored, "Rank sources by trust; false: the first that fits, forwards, then backwards, as published.");
    table.add("sources", sources, {1, 8}, "Most sources of a pixel; those that agree are averaged.");
    table.add("max_error_px", max_error_px, {0.1, 1000},
              "Sources whose copy is expected to be off or blurred by more pixels are not used.");
    table.add("footprint", footprint, "Average the source pixels that one target pixel covers.");
  }
};

/// Where other frames saw each hole pixel of the target (section 3.2 of the paper): the pixel's point, by its depth, is looked
/// up in the frames around it in time, then in the source drives; a frame counts that has it inside its image, outside its
/// mask, and sees that very surface. Up to `sources` of them, by falling trust().
Candidates sample(const depth::Target& target, const SampleOptions& options);

/// The same for known pixels round the hole: each is looked up in those frames of its own drive that the nearest pixel of the
/// hole was found in, so that what copies from these frames are worth can be read where the truth is known.
Candidates sample_known(const depth::Target& target, const Candidates& hole, const SampleOptions& options);

/// The order in which sample() asks the other views: scored, from the target outwards in time, else as published, forwards,
/// then backwards; source drives after its own, the nearest places first. Not those that show no colors the target could take.
std::vector<std::size_t> search_order(const Views& views, std::size_t target, const SampleOptions& options);

}  // namespace dvi::sample
