#pragma once

#include "dvi/drive/view.h"
#include "dvi/ground/road_ground.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/synthesize/completed_views.h"
#include "dvi/synthesize/surface_guide.h"

namespace dvi::synthesize {

/// Replaces the colors of interpolated pixels by those of completed views, and by exemplars where no completed view shows them;
/// their kind becomes `synthesized`. `index` is the frame's view. Images that are only referred to by `frame` are released as
/// soon as they are replaced.
SynthesizedFrame synthesize(ClassifiedFrame frame, const Views& views, std::size_t index, const CompletedViews& completed);

}  // namespace dvi::synthesize
