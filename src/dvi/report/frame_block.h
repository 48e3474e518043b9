#pragma once

#include <cstddef>
#include <string>

#include <opencv2/core/mat.hpp>

#include "dvi/report/frame_pictures.h"

namespace dvi::report {

/// The script data_NNNNNN.js: the receipts of a frame's hole. A browser that opens a page from disk lets scripts read scripts,
/// not pictures.
///
/// Its bytes, in base64 of zlib: the plane of kinds, then, for the hole's pixels in raster order, one field after the other as
/// the header names them. Two bytes a value are kept as differences from the value before, low bytes first, then high bytes.
/// `error`: largest difference of a channel to the truth; empty: there is no truth.
std::string frame_block(std::size_t number, const FramePictures& pictures, const cv::Mat1b& error);

}  // namespace dvi::report
