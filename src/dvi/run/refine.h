#pragma once

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/recordings.h"
#include "dvi/map/visible_points.h"

namespace dvi::run {

/// What the exposure and the poses of views are refined by. Refers to these only.
struct Refinement {
  const Views& views;
  const map::VisibleMap& map;
  const inputs::Recordings& drives;  ///< for their names
  const job::Options& options;
};

/// Estimates the exposure with progress, and warns of the frames whose gain nothing determines. All gains are 1 where it is
/// switched off.
exposure::Gains estimate_exposure(const Refinement& from, Progress& progress);

/// Refines the poses with progress, and passes on the warnings.
align::Cameras align(const Refinement& from, Progress& progress);

}  // namespace dvi::run
