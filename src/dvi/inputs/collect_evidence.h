#pragma once

#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/objects/draw_masks.h"

namespace dvi::inputs {

/// What one recording shows of the objects to remove. Refers to the recording and the trajectory, which must outlive it.
objects::CameraEvidence evidence_of(const Recording& open, const Trajectory& world_from_lidar);

/// The evidence of all recordings, with the scans whose poses are known to be wrong. Refers to `drives` and `poses`, which must
/// outlive it.
objects::Evidence collect_evidence(const Recordings& drives, const Poses& poses);

/// The masks of all recordings: their evidence collected, the objects found, and drawn.
objects::Masks find_masks(const Recordings& drives, const Poses& poses, const job::Job& job, Progress& progress);

}  // namespace dvi::inputs
