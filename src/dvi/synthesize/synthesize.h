#pragma once

#include "dvi/drive/view.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/synthesize/completed_views.h"
#include "dvi/synthesize/surface_guide.h"

namespace dvi::synthesize {

/// A frame whose unobserved pixels are synthesized.
struct SynthesizedFrame {
  harmonize::FilledFrame frame;
  cv::Mat1b completed;  ///< 255: the pixel is not shown by any completed view and was completed in this frame.
  SurfaceGuide guide;   ///< The surfaces of its pixels; empty if no pixel is unobserved.
};

/// Replaces the colors of interpolated pixels by those of completed views, and by exemplars where no completed view shows them;
/// their kind becomes `synthesized`. `index` is the frame's view. `classes` are the harmonize::SurfaceClass of its pixels;
/// empty: all unknown.
SynthesizedFrame synthesize(const harmonize::FilledFrame& frame, const Views& views, std::size_t index,
                            const cv::Mat1b& classes, const ground::RoadGround& ground, const CompletedViews& completed_views);

}  // namespace dvi::synthesize
