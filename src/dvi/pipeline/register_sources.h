#pragma once

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"
#include "dvi/pipeline/poses.h"

namespace dvi::pipeline {

/// Lays the source drives onto the target by their scans (registration/registration.h), which bends the trajectories of all
/// drives. Given poses in one world are where it begins, and stay where scans do not confirm them, with a warning; `--poses
/// given` keeps them as they are. `poses` are those of in_one_world(). InputError for a source drive that is the target itself,
/// one that overlaps with none, and one whose place cannot be told.
void register_sources(const Recordings& drives, const Job& job, Poses& poses, Progress& progress);

}  // namespace dvi::pipeline
