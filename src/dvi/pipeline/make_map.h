#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"
#include "dvi/pipeline/open.h"

namespace dvi::pipeline {

/// Stage 3, as a stage of `progress`; warns where nothing is left.
map::StaticMap map_drives(const std::vector<OpenDrive>& drives, const map::MapOptions& options, Progress& progress);

/// `dvi map`: poses and static map of job.target into job.out. Masks are used where the drive has some. `trajectory`: none,
/// kitti or tum: trajectory.txt beside them. Returns map.json.
std::string make_map(const Job& job, const std::string& trajectory, Progress& progress);

}  // namespace dvi::pipeline
