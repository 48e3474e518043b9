#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// Gray of a BGR image, rounded to 8 bits (ITU-R BT.601, as OpenCV converts).
cv::Mat1b gray_8bit(const cv::Mat3b& image);

}  // namespace dvi
