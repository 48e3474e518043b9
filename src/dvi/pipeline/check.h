#pragma once

#include <string>

#include "dvi/core/progress.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// What `dvi check` found, for machines and for people.
struct CheckReport {
  std::string json, text;
};

/// Reads all of job.target once and says what it is: format, camera, frames, sweeps, points, poses, masks, what of it is
/// missing or odd, and, if it is ready for a run, how much of its holes other frames will have seen. InputError where something
/// is too bad to go on with.
CheckReport check(const Job& job, Progress& progress);

}  // namespace dvi::pipeline
