#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/inputs/inputs.h"

namespace dvi::inputs {

/// Warns where a recording contradicts its camera, its clock, or its labels (diagnostics/), and returns the warnings. Labels
/// are not checked if there is a warning about the camera, because boxes may be derived from its calibration.
std::vector<std::string> check_setup(const Inputs& inputs, Progress& progress);

}  // namespace dvi::inputs
