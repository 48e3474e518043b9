#pragma once

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/drive/view.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/inputs.h"

namespace dvi::inputs {

/// Makes a view of each posed frame of all drives. Frames without a pose are left out with a warning.
Views make_views(const Inputs& inputs, Progress& progress);

/// Makes a view of each frame of all drives, with the identity as its pose, for methods that do not use poses.
Views make_unposed_views(const Recordings& drives, const objects::Masks& masks);

/// Returns the views with the gains, vignetting, and refined poses set. `gains` and `cameras` have one entry per view.
Views refine_views(const Views& views, const exposure::Gains& gains, const align::Cameras& cameras);

}  // namespace dvi::inputs
