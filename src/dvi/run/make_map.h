#pragma once

#include <string>

#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"

namespace dvi::run {

/// The static map of all drives (section 3.1 of the paper), as a stage of `progress`. InputError that counts the reasons
/// where no static point remains.
map::StaticMap build_map(const inputs::Inputs& inputs, const map::MapOptions& options, Progress& progress);

/// `dvi map`: poses and static map of job.target into job.out. Masks are used where the drive has some. `trajectory`: none,
/// kitti or tum: trajectory.txt beside them. Returns map.json. InputError where job.out is, holds or lies in an input.
std::string make_map(const job::Job& job, const std::string& trajectory, Progress& progress);

}  // namespace dvi::run
