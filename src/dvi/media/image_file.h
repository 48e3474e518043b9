#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// Width and height by the header of a PNG or JPEG, without decoding it. InputError where it is neither or is too large.
cv::Size image_size(const fs::path& path);

/// The same of a file's bytes, and the image in BGR that they are; `name` is for messages.
cv::Size image_size(const fs::path& name, const std::string& bytes);
cv::Mat3b decode_image(const fs::path& name, const std::string& bytes, cv::Size size);

/// The image in BGR, as it is stored: an EXIF orientation is not applied, because calibration and scans do not turn with it.
/// InputError where it cannot be decoded as a whole or has another size, which the header tells.
cv::Mat3b read_image(const fs::path& path, cv::Size size);

/// The mask: 255 where any color of the file is not 0, of whatever depth. Transparency counts only in a file of one color all
/// over, and where it tells pixels apart: 255 where some of it is not 0. Errors and orientation as read_image.
cv::Mat1b read_mask(const fs::path& path, cv::Size size);

/// The same of a picture as read_unchanged() returns it.
cv::Mat1b mask_of(const cv::Mat& picture);

/// The image as the file has it, but where it has a palette the indices, as one channel of 8 bits. Errors as read_image.
cv::Mat read_indices(const fs::path& path, cv::Size size);

/// The image as the file has it: its depth and channels (BGR where there are three). Empty where it is no whole PNG or JPEG of
/// that size; InputError where it is too large.
cv::Mat read_unchanged(const fs::path& path, cv::Size size);

}  // namespace dvi::media
