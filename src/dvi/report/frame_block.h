#pragma once

#include <cstddef>
#include <string>

#include <opencv2/core/mat.hpp>

#include "dvi/report/frame_pictures.h"

namespace dvi::report {

/// Formats the script data_NNNNNN.js with the provenance of a frame's hole. It is a script because a page that is opened from
/// disk may load scripts, but not read images.
///
/// Its bytes, compressed by zlib and in base64, are the plane of kinds and then, for the pixels of the hole in raster order,
/// one field after another as named in the header. Values of two bytes are differences from the value before; all low bytes
/// come first, then all high bytes. `error` is the largest difference of a channel from the truth; empty if there is no truth.
std::string format_frame_block(std::size_t number, const FramePictures& pictures, const cv::Mat1b& error);

}  // namespace dvi::report
