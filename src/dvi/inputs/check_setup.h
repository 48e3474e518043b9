#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"

namespace dvi::inputs {

/// Warns where a recording contradicts its camera, its clock or its labels (plausibility/), and returns the warnings. Labels
/// are not judged where the camera is in doubt: boxes may come from it.
std::vector<std::string> check_setup(const Inputs& inputs, Progress& progress);

}  // namespace dvi::inputs
