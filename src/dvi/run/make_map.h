#pragma once

#include <optional>
#include <string>

#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"
#include "dvi/result/map_files.h"

namespace dvi::run {

/// Builds the static map of all drives (section 3.1 of the paper), as a stage of `progress`. Throws InputError, with the number
/// of returns per reason, if no static point remains.
map::StaticMap build_map(const inputs::Inputs& inputs, const map::MapOptions& options, Progress& progress);

/// Runs `dvi map`: writes poses and static map of job.target to job.out. Masks are used if the drive has any. With a
/// format, writes trajectory.txt, too. Returns map.json. Throws InputError if job.out is, contains, or is inside
/// of an input.
std::string make_map(const job::Job& job, std::optional<result::TrajectoryFormat> trajectory, Progress& progress);

}  // namespace dvi::run
