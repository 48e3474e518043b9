#pragma once

#include "dvi/baselines/hole_flow.h"
#include "dvi/core/lazy.h"
#include "dvi/core/options.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::baselines {

/// What is done without LiDAR, for comparison: images and masks are all that these look at. Nothing is blended, the depth
/// of their frames is unknown.

/// How OpenCV fills a hole from around it: A. Telea 2004, fast marching; M. Bertalmio et al. 2001, Navier-Stokes.
enum class Inpainting { telea, navier_stokes };

/// Each hole filled from its own frame, radius 3 px. A frame that is all hole stays black, kind 5.
harmonize::FilledFrame inpaint_frame(const Views& views, std::size_t target, Inpainting method);

struct FlowOptions {
  int max_frames = 30;
  double consistency_px = 1.5;

  void describe(OptionTable& table) {
    table.section("flow");
    table.developer();
    table.add("max_frames", max_frames, {1, 1000}, "Method flow: most frames over which a pixel is tracked, either way.");
    table.add("consistency_px", consistency_px, {0.1, 20}, "Method flow: largest error of the forward-backward check.");
  }
};

/// The flow between each view and the next, on demand; of the views' order only that within a drive has a meaning.
Lazy<HoleFlow> hole_flows(const Views& views, const FlowOptions& options);

/// Each hole pixel is followed along the flow, frame by frame forwards and backwards at once, until one of the two leaves the
/// masks, and copied from there; what never does, or loses its way, is filled as by Telea. `flows` as hole_flows() gives.
harmonize::FilledFrame flow_fill(const Views& views, std::size_t target, const Lazy<HoleFlow>& flows,
                                 const FlowOptions& options);

}  // namespace dvi::baselines
