#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "dvi/core/files.h"

namespace dvi::media {

/// Returns the memory of data that take so many bytes per pixel of an image, by the largest of the first images of each camera
/// in a folder of the frames of a result ("kind"); 0 if there is none.
std::size_t estimate_image_bytes(const fs::path& out, const std::string& folder, const std::vector<std::string>& frames,
                                 std::size_t bytes_per_pixel);

}  // namespace dvi::media
