#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

namespace dvi::media {

/// The bytes of a PNG (RFC 2083) that holds the image: 8-bit gray, BGR (an RGB file) or BGRA; 16-bit gray, or 16-bit triples
/// whose channels 0, 1, 2 are the file's R, G, B. Much faster than libpng with zlib, for files of about the same size.
std::string encode_png(const cv::Mat& image);

}  // namespace dvi::media
