#pragma once

#include <vector>

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/map/static_map.h"
#include "dvi/pipeline/job.h"
#include "dvi/pipeline/open.h"

namespace dvi::pipeline {

/// estimate_exposure with progress, and a warning for the frames whose light nothing tells.
void share_light(Views& views, const map::StaticMap& map, const std::vector<OpenDrive>& drives, const Options& options,
                 Progress& progress);

/// align with progress and its warnings.
align::Alignment align_views(Views& views, const map::StaticMap& map, const Options& options, Progress& progress);

}  // namespace dvi::pipeline
