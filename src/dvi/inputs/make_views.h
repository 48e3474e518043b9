#pragma once

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/drive/view.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/inputs.h"

namespace dvi::inputs {

/// All posed frames of all drives. Frames without a pose are left out with a warning.
Views make_views(const Inputs& inputs, Progress& progress);

/// All frames of all drives, whether posed or not, each with the identity for its pose: for what does not look at poses.
Views make_unposed_views(const Recordings& drives, const objects::Masks& masks);

/// The same views with the gains and poses that were found for them.
Views refined(const Views& views, const exposure::Gains& gains, const align::Cameras& cameras);

}  // namespace dvi::inputs
