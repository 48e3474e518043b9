#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// Writes a PNG beside its path and renames it: 8-bit gray, BGR (an RGB file) or BGRA; 16-bit gray, or 16-bit triples whose
/// channels 0, 1, 2 become the file's R, G, B. Throws InputError on a full or read-only disk.
void write_png(const fs::path& path, const cv::Mat& image);

/// Writes a JPEG of 8-bit BGR in the same way, for images that are only viewed.
void write_jpeg(const fs::path& path, const cv::Mat3b& image, int quality);

/// Read images exactly as written by write_png(), without any conversion (for images and masks, see media/image_file.h). Throw
/// InputError if the file cannot be read or holds another type or size of image.
cv::Mat1b read_png_gray(const fs::path& path, cv::Size size);               ///< 8-bit, one channel
cv::Mat1w read_png_depth(const fs::path& path, cv::Size size);              ///< 16-bit, one channel
cv::Mat_<cv::Vec3w> read_png_triples(const fs::path& path, cv::Size size);  ///< 16-bit, R, G, B as channels 0, 1, 2

}  // namespace dvi::media
