#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::io {

/// Width and height by the header of a PNG or JPEG, without decoding it. InputError where it is neither.
cv::Size image_size(const fs::path& path);

/// The image in BGR. InputError where it cannot be decoded as a whole or has another size.
cv::Mat3b read_image(const fs::path& path, cv::Size size);

/// The mask: 255 where the file is not black. Errors as read_image.
cv::Mat1b read_mask(const fs::path& path, cv::Size size);

/// The image as the file has it: its depth and channels (BGR where there are three). Empty where it is no whole image.
cv::Mat read_unchanged(const fs::path& path);

}  // namespace dvi::io
