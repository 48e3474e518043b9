#pragma once

#include "dvi/baselines/hole_flow.h"
#include "dvi/core/lazy.h"
#include "dvi/core/options.h"
#include "dvi/drive/view.h"
#include "dvi/harmonize/filled_frame.h"

namespace dvi::baselines {

// Methods without LiDAR, for comparison. They use images and masks only. Colors are not blended, and the depth is unknown.

/// The inpainting methods of OpenCV: A. Telea 2004 (fast marching), and M. Bertalmio et al. 2001 (Navier-Stokes).
enum class Inpainting { telea, navier_stokes };

/// Fills the holes of a frame by inpainting with a radius of 3 px. A frame that is completely masked stays black, with kind 5.
harmonize::FilledFrame inpaint_frame(const Views& views, std::size_t target, Inpainting method);

struct FlowOptions {
  int max_frames = 30;
  double consistency_px = 1.5;

  void describe(OptionTable& table) {
    table.section("flow");
    table.developer();
    table.add("max_frames", max_frames, {1, 1000},
              "Method flow: largest number of frames over which a pixel is tracked, in each direction.");
    table.add("consistency_px", consistency_px, {0.1, 20}, "Method flow: largest error of the forward-backward check.");
  }
};

/// Computes the flow between each view and the next, on demand. It is meaningful only within a drive.
Lazy<HoleFlow> make_hole_flows(const Views& views, const FlowOptions& options);

/// Fills a frame along optical flow: each hole pixel is tracked frame by frame, forward and backward at the same time, and
/// copied from the first frame in which it is outside the masks. Pixels that never are, or whose flow is inconsistent, are
/// inpainted (Telea). `flows` are those of make_hole_flows().
harmonize::FilledFrame fill_along_flow(const Views& views, std::size_t target, const Lazy<HoleFlow>& flows,
                                       const FlowOptions& options);

}  // namespace dvi::baselines
