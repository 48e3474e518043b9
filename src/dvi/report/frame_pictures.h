#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/files.h"

namespace dvi::report {

/// What a result holds of one frame besides its colors, as harmonize::FilledFrame has it. All are of one size; a picture that
/// is missing or damaged is empty.
struct FramePictures {
  cv::Mat1b kind, confidence;
  cv::Mat1w depth;  ///< meters x 256, 0 unknown
  cv::Mat_<cv::Vec3w> provenance, harmonization;
  cv::Mat3b used;
  std::vector<std::string> missing;  ///< files that cannot be read, relative to the result
};

/// `all`: also provenance, harmonization and used.
FramePictures read_pictures(const fs::path& out, const std::string& name, bool all);

/// The frame itself; empty where it cannot be read.
cv::Mat3b read_frame(const fs::path& file, cv::Size size);

}  // namespace dvi::report
