#pragma once

#include "dvi/core/progress.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"

namespace dvi::inputs {

/// Adds the other cameras of the target that the job cleans (`--camera A,B`) after its first, and appends the other cameras of
/// each drive that the job uses as sources (`--sources`), with their images during the drive's frames, gray cameras last. Sets
/// which recordings are gray: only structure is compared between gray and colored images. The cameras share the scans of their
/// drive. Their masks are their own mask files, or drawn from objects found in the scans or from labeled boxes, or else the
/// masks of the drive's own camera, reprojected (objects/reprojected_mask.h). A camera that cannot be read is left out with a
/// warning. Throws UsageError if `--sources` names a camera that does not exist.
Recordings add_other_cameras(Recordings drives, const job::Job& job, Progress& progress);

}  // namespace dvi::inputs
