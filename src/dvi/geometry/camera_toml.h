#pragma once

#include <string>

#include "dvi/geometry/camera.h"

namespace dvi {

/// Returns the lines K, model, xi, and distortion of a camera in dvi.toml; those of a pinhole camera without distortion are K
/// only. Numbers are written with all digits that are needed to read them back exactly.
std::string format_intrinsics(const Camera& camera);

}  // namespace dvi
