#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// Grey of a BGR image, rounded to 8 bits (ITU-R BT.601, as OpenCV converts).
cv::Mat1b grey_8bit(const cv::Mat3b& image);

}  // namespace dvi
