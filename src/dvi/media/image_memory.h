#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::media {

/// Returns the memory of data that take so many bytes per pixel of an image, by the first of the images NAME.png of a folder; 0
/// if there is none.
std::size_t estimate_image_bytes(const fs::path& folder, const std::vector<std::string>& names, std::size_t bytes_per_pixel);

}  // namespace dvi::media
