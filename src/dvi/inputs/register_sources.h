#pragma once

#include "dvi/core/progress.h"
#include "dvi/inputs/poses.h"
#include "dvi/job/job.h"

namespace dvi::inputs {

/// Registers the source drives to the target by their scans (registration/registration.h), which deforms the trajectories of
/// all drives. `poses` are those of transform_to_target_world(). Given poses in one world are the initial guess. They are kept,
/// with a warning, if the scans do not confirm them, and are not changed with `--poses given`. Throws InputError for a source
/// drive that is the target itself, that does not overlap with it, or whose place is ambiguous.
void register_sources(const Recordings& drives, const job::Job& job, Poses& poses, Progress& progress);

}  // namespace dvi::inputs
