#pragma once

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/recordings.h"
#include "dvi/map/visible_points.h"

namespace dvi::run {

/// estimate_exposure with progress, and a warning for the frames whose gain nothing tells. All 1 where it is switched off.
exposure::Gains estimate_exposure(const Views& views, const map::VisibleMap& map, const inputs::Recordings& drives,
                                  const job::Options& options, Progress& progress);

/// align with progress and its warnings.
align::Cameras align(const Views& views, const map::VisibleMap& map, const inputs::Recordings& drives,
                     const job::Options& options, Progress& progress);

}  // namespace dvi::run
