#pragma once

#include <cstddef>

#include "dvi/core/files.h"

namespace dvi::media {

/// Returns the memory of data that take so many bytes per pixel of an image file; 0 if the file does not exist.
std::size_t estimate_image_bytes(const fs::path& file, std::size_t bytes_per_pixel);

}  // namespace dvi::media
