#pragma once

#include "dvi/inputs/poses.h"
#include "dvi/inputs/recordings.h"
#include "dvi/objects/draw_masks.h"

namespace dvi::inputs {

/// Returns the evidence of one recording about the objects to remove. It refers to the recording and to the trajectory, which
/// must outlive it.
objects::CameraEvidence evidence_of(const Recording& open, const Trajectory& world_from_lidar);

/// Collects the evidence of all recordings, and marks the scans whose poses are known to be wrong. The result refers to
/// `drives` and `poses`, which must outlive it.
objects::Evidence collect_evidence(const Recordings& drives, const Poses& poses);

/// Collects the evidence of all recordings, finds the objects to remove, and draws their masks, one entry per recording.
objects::Masks find_masks(const Recordings& drives, const Poses& poses, const job::Job& job, Progress& progress);

}  // namespace dvi::inputs
