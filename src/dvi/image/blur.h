#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// An image of floats, blurred by a Gaussian of so many pixels along rows and columns, reflected at its edges. A wide one is
/// applied to means over blocks and interpolated between them, which blur, too, and are counted: off by 1 % of the image's
/// range at most.
cv::Mat blurred(const cv::Mat& image, double sigma_x, double sigma_y);
inline cv::Mat blurred(const cv::Mat& image, double sigma) { return blurred(image, sigma, sigma); }

}  // namespace dvi
