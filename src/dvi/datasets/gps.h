#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/geometry/earth_place.h"

namespace dvi::datasets {

/// Reads lines "seconds latitude longitude [x y z]": degrees of WGS84, and the antenna's position in the LiDAR's axes (meters).
/// Throws InputError if a line is malformed or if its position is not on Earth.
std::vector<GeoFix> read_fixes(const fs::path& file);

/// Formats fixes as the text of such a file.
std::string format_fixes(const std::vector<GeoFix>& fixes);

}  // namespace dvi::datasets
