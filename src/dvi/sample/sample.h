#pragma once

#include "dvi/core/options.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"
#include "dvi/sample/candidates.h"

namespace dvi {

struct SampleOptions {
  bool occlusion_test = true;
  double occlusion_tolerance = 0.05;
  int reach_frames = 120;

  void describe(OptionTable& table) {
    table.section("sample");
    table.add("occlusion_test", occlusion_test, "A source counts only if it sees the pixel's surface, not one before it.");
    table.add("occlusion_tolerance", occlusion_tolerance, {0, 1},
              "A surface in the source is before the pixel's if nearer by more than this part.");
    table.add("reach_frames", reach_frames, {0, 1000000},
              "Frames searched in either direction of time, and nearest ones of further drives; 0: all, as published.");
  }
};

/// Where other frames saw each hole pixel of the target (section 3.4 of the paper): the pixel's point, by its depth, is looked
/// up forwards in time to the end of the drive, then backwards to its beginning, then in the further drives; the first frame
/// that has it inside its image, outside its mask and not occluded gives the candidate. `depth` is the target's;
/// `visibility` is as `views`, and asked only for views that may show a pixel.
Candidates sample(const Views& views, std::size_t target, const DepthMap& depth, const Lazy<VisibilityMap>& visibility,
                  const SampleOptions& options);

/// The order in which sample() asks the other views.
std::vector<std::size_t> search_order(const Views& views, std::size_t target, int reach_frames);

}  // namespace dvi
