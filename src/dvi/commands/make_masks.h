#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::commands {

/// `dvi mask`: what is removed from job.target, as a run would decide it, without running: job.out/masks/CAMERA/NAME.png,
/// contact.png and masks.json, which `--masks` takes back. Returns masks.json. InputError where job.out is not empty, or is,
/// holds or lies in an input.
std::string make_masks(const job::Job& job, Progress& progress);

}  // namespace dvi::commands
