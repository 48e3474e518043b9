#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::media {

/// Returns the bytes of a scan's file without some of its points: .ply, .pcd, or rows of equal size without a header, such as
/// .bin and .label. `removed` has one item per point of the file. Files get shorter, and the number of points in their header
/// smaller; an organized .pcd keeps its size, and the coordinates of removed points become NaN. All other bytes are kept.
/// Throws InputError if the file is malformed or has another number of points, if other elements follow the points (faces), or
/// if the coordinates of an organized .pcd cannot be NaN.
std::string remove_points(const fs::path& path, const std::string& bytes, const std::vector<bool>& removed);

}  // namespace dvi::media
