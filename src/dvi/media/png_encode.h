#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

namespace dvi::media {

/// Encodes an image as PNG (RFC 2083): 8-bit gray, BGR (an RGB file) or BGRA; 16-bit gray, or 16-bit triples whose channels 0,
/// 1, 2 become the file's R, G, B. It is much faster than libpng with zlib, with files of about the same size.
std::string encode_png(const cv::Mat& image);

}  // namespace dvi::media
