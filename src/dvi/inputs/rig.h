#pragma once

#include "dvi/core/progress.h"
#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/job/job.h"

namespace dvi::inputs {

/// Appends the other cameras of each drive that the job lets lend (`--sources`), as far as they took images during the drive's
/// frames, gray ones last, and tells which recordings are gray: between those and colored ones only structure is compared.
/// They share the scans of their drive. What they see of its traffic is told by mask files of their own, by objects found in
/// the scans, by labeled boxes, else by the masks of the drive's own camera, carried over (masks/carried.h). A
/// camera that cannot be read is left out with a warning; UsageError where it was asked for by name and is not there.
Recordings with_other_cameras(Recordings drives, const job::Job& job, Progress& progress);

/// The masks of the drive's own camera (`own`, as its frames), carried over to another camera of it. A frame of which that
/// camera has none at the same time is masked all over.
Lazy<cv::Mat1b> carried_masks(const Drive& drive, const Lazy<cv::Mat1b>& own, const Drive& other,
                              const Trajectory& world_from_lidar);

}  // namespace dvi::inputs
