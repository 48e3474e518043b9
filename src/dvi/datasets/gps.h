#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/geometry/earth_place.h"

namespace dvi::datasets {

/// Reads lines "seconds latitude longitude [x y z]": degrees of WGS84, and where the antenna is in the LiDAR's axes (meters).
/// InputError where a line is of another form or names no place on Earth.
std::vector<GeoFix> read_fixes(const fs::path& file);

/// The text of such a file.
std::string fixes_text(const std::vector<GeoFix>& fixes);

}  // namespace dvi::datasets
