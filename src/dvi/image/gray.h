#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// Converts a BGR image to gray, rounded to 8 bits (ITU-R BT.601 as in OpenCV).
cv::Mat1b gray_8bit(const cv::Mat3b& image);

}  // namespace dvi
