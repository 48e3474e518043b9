#pragma once

#include <string_view>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// Returns whether a file is an array of NumPy, by its ending.
bool is_numpy(const fs::path& file);

/// Reads a NumPy array (.npy, format 1 to 3) of height x width, with or without a dimension of 1 before or after them: bool
/// (255 = true), integers of 1 to 8 bytes, or float with whole numbers. Negative numbers become 0. Returns one channel of 8
/// bits, or of 16 bits if a number is above 255. Throws InputError if the array differs in size, has another kind or order, is
/// truncated, or has numbers above 65535.
cv::Mat read_numpy(const fs::path& file, cv::Size size);

/// Does the same for a file's bytes; `name` is used in messages.
cv::Mat parse_numpy(const fs::path& name, std::string_view bytes, cv::Size size);

}  // namespace dvi::media
