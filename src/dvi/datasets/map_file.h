#pragma once

#include <optional>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// Finds the map in a drive's folder: map.ply, map.pcd or map.las. Returns nothing if there is none. Throws InputError if there
/// are two.
std::optional<fs::path> find_map(const fs::path& drive);

/// Throws InputError with the conversion to use if a drive's folder has a map in a format that is not supported, such as
/// map.laz.
void refuse_other_map(const fs::path& drive);

/// Gives a drive the map of a file instead of scans. The file is read on first use, which throws InputError if it is damaged.
void attach_map(Drive& drive, const fs::path& file);

}  // namespace dvi::datasets
