#pragma once

#include "dvi/core/progress.h"
#include "dvi/inputs/poses.h"
#include "dvi/job/job.h"

namespace dvi::inputs {

/// Lays the source drives onto the target by their scans (registration/registration.h), which bends the trajectories of all
/// drives. Given poses in one world are where it begins, and stay where scans do not confirm them, with a warning; `--poses
/// given` keeps them as they are. `poses` are those of in_one_world(). InputError for a source drive that is the target itself,
/// one that overlaps with none, and one whose place cannot be told.
void register_sources(const Recordings& drives, const job::Job& job, Poses& poses, Progress& progress);

}  // namespace dvi::inputs
