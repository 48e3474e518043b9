#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi {

/// Writes a PNG beside its place and renames it. 8-bit grey or BGR (an RGB file); 16-bit grey, or 16-bit triples whose
/// channels 0, 1, 2 are the file's R, G, B (a receipt has no colour). InputError on a full or read-only disk.
void write_png(const fs::path& path, const cv::Mat& image);

/// What write_png wrote, or any file of that kind. InputError where it cannot be read or holds another kind of image.
cv::Mat3b read_png_colour(const fs::path& path);             ///< 8-bit BGR; grey and palette files become BGR
cv::Mat1b read_png_grey(const fs::path& path);               ///< 8-bit, one channel
cv::Mat1w read_png_depth(const fs::path& path);              ///< 16-bit, one channel
cv::Mat_<cv::Vec3w> read_png_triples(const fs::path& path);  ///< 16-bit, the file's R, G, B as channels 0, 1, 2

}  // namespace dvi
