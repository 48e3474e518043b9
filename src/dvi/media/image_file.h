#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// Returns width and height by the header of a PNG or JPEG, without decoding it. Throws InputError if the file is neither or is
/// too large.
cv::Size image_size(const fs::path& path);

/// Do the same for a file's bytes, and decode them to BGR; `name` is used in messages.
cv::Size image_size(const fs::path& name, const std::string& bytes);
cv::Mat3b decode_image(const fs::path& name, const std::string& bytes, cv::Size size);

/// Decodes a file's bytes with the channels of the file (BGR if there are three). Errors are as for decode_image().
cv::Mat decode_unchanged(const fs::path& name, const std::string& bytes, cv::Size size);

/// Reads an image in BGR as it is stored. EXIF orientations are not applied, because calibration and scans do not rotate with
/// them. Throws InputError if the image cannot be decoded completely, or has another size by its header.
cv::Mat3b read_image(const fs::path& path, cv::Size size);

/// Reads a mask: 255 where any color of the file is not 0, at any bit depth. If all colors of the file are equal and its
/// transparency varies, 255 where the transparency channel is not 0. With a palette of colors, 255 where the index is not 0,
/// whatever the color of index 0. Reads arrays of NumPy as well. Errors and orientation are as for read_image().
cv::Mat1b read_mask(const fs::path& path, cv::Size size);

/// Converts an image from read_unchanged() to such a mask.
cv::Mat1b to_mask(const cv::Mat& picture);

/// Reads the stored image or array of NumPy; with a palette, the indices as one 8-bit channel. Errors are as for read_image().
cv::Mat read_indices(const fs::path& path, cv::Size size);

/// Reads the stored image with its bit depth and channels (BGR if there are three). Returns an empty image if the file is not a
/// complete PNG or JPEG of that size. Throws InputError if it is too large, and for an array of NumPy like read_numpy().
cv::Mat read_unchanged(const fs::path& path, cv::Size size);

}  // namespace dvi::media
