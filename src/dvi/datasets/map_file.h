#pragma once

#include <optional>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The map that lies in a drive's folder: map.ply, map.pcd or map.las. None where there is none; InputError where there are
/// two.
std::optional<fs::path> find_map(const fs::path& drive);

/// InputError where a drive's folder has a map in a format that is not read, such as map.laz, with the way to convert it.
void refuse_other_map(const fs::path& drive);

/// Gives a drive the map of a file instead of scans. It is read when first asked for; InputError then where it is damaged.
void attach_map(Drive& drive, const fs::path& file);

}  // namespace dvi::datasets
