#pragma once

#include "dvi/align/align.h"
#include "dvi/core/progress.h"
#include "dvi/exposure/exposure.h"
#include "dvi/inputs/recordings.h"
#include "dvi/map/visible_points.h"

namespace dvi::run {

/// The inputs from which the exposure and the poses of views are refined. Holds references only.
struct Refinement {
  const Views& views;
  const map::VisibleMap& map;
  const inputs::Recordings& drives;  ///< for their names
  const job::Options& options;
};

/// Estimates the exposure gains of all views, as a stage of `progress`, and warns of frames that share too few map points with
/// others. All gains are 1 if the stage is switched off.
exposure::Gains estimate_exposure(const Refinement& from, Progress& progress);

/// Refines the poses of all views, as a stage of `progress`, and reports its warnings.
align::Cameras align(const Refinement& from, Progress& progress);

}  // namespace dvi::run
