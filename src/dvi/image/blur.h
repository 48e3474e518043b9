#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi {

/// Blurs an image of floats by a Gaussian of the given pixels along rows and columns, reflected at the edges. A wide Gaussian
/// is applied to means over blocks and interpolated between them; their blur is taken into account. The error is at most 1 % of
/// the image's range.
cv::Mat blurred(const cv::Mat& image, double sigma_x, double sigma_y);
inline cv::Mat blurred(const cv::Mat& image, double sigma) { return blurred(image, sigma, sigma); }

}  // namespace dvi
