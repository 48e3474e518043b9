#pragma once

#include <string>

#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"

namespace dvi::run {

/// Builds the static map of all drives (section 3.1 of the paper), as a stage of `progress`. Throws InputError, with the number
/// of returns per reason, if no static point remains.
map::StaticMap build_map(const inputs::Inputs& inputs, const map::MapOptions& options, Progress& progress);

/// Runs `dvi map`: writes poses and static map of job.target to job.out. Masks are used if the drive has any. `trajectory` is
/// none, kitti, or tum, the format of trajectory.txt. Returns map.json. Throws InputError if job.out is, contains, or is inside
/// of an input.
std::string make_map(const job::Job& job, const std::string& trajectory, Progress& progress);

}  // namespace dvi::run
