#pragma once

#include <string>

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"

namespace dvi {

/// `dvi map`: poses and static map of job.target into job.out. Masks are used where the drive has some. Returns map.json.
std::string make_map(const Job& job, Progress& progress);

}  // namespace dvi
