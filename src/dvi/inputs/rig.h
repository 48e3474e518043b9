#pragma once

#include "dvi/core/progress.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"

namespace dvi::inputs {

/// Appends the other cameras of each drive that the job uses as sources (`--sources`), as far as they took images during the
/// drive's frames, gray ones last, and sets which recordings are gray: between those and colored ones only structure is
/// compared. They share the scans of their drive. Their masks are mask files of their own, or drawn from objects found in the
/// scans or from labeled boxes, else those of the drive's own camera, reprojected (objects/reprojected_mask.h). A camera that
/// cannot be read is left out with a warning; UsageError where it was asked for by name and is not there.
Recordings with_other_cameras(Recordings drives, const job::Job& job, Progress& progress);

}  // namespace dvi::inputs
