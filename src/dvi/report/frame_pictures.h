#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::report {

/// The images of one frame of a result besides its colors, as in harmonize::FilledFrame. All have the same size; an image that
/// is missing or damaged is empty.
struct FramePictures {
  cv::Mat1b kind, confidence;
  cv::Mat1w depth;  ///< meters x 256; 0 if unknown
  cv::Mat_<cv::Vec3w> provenance, harmonization;
  cv::Mat3b used;
  std::vector<std::string> missing;  ///< files that cannot be read, relative to the result
};

/// Reads the images of a frame; with `all`, also provenance, harmonization, and used.
FramePictures read_pictures(const fs::path& out, const std::string& name, bool all);

/// Reads the frame itself; empty if it cannot be read.
cv::Mat3b read_frame(const fs::path& file, cv::Size size);

}  // namespace dvi::report
