#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// Writes a PNG beside its place and renames it. 8-bit gray, BGR (an RGB file) or BGRA; 16-bit gray, or 16-bit triples whose
/// channels 0, 1, 2 are the file's R, G, B (a receipt has no color). InputError on a full or read-only disk.
void write_png(const fs::path& path, const cv::Mat& image);

/// Writes a JPEG of 8-bit BGR likewise, for pictures that are looked at only.
void write_jpeg(const fs::path& path, const cv::Mat3b& image, int quality);

/// Receipts as write_png wrote them, without any conversion (pictures and masks: io/image_file.h). InputError where the file
/// cannot be read or holds another kind or size of image.
cv::Mat1b read_png_gray(const fs::path& path, cv::Size size);               ///< 8-bit, one channel
cv::Mat1w read_png_depth(const fs::path& path, cv::Size size);              ///< 16-bit, one channel
cv::Mat_<cv::Vec3w> read_png_triples(const fs::path& path, cv::Size size);  ///< 16-bit, R, G, B as channels 0, 1, 2

}  // namespace dvi::media
