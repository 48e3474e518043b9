#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace dvi::align {

/// The texture of an image without its light: the logarithm of its brightness between two blurs, so that a gain of the whole
/// frame, or one that changes slowly across it, drops out. Masked pixels are left out of the blurs. Level l is the image at
/// 1 / 2^l of its size.
using BandPass = std::vector<cv::Mat1f>;
BandPass band_pass(const cv::Mat3b& image, const cv::Mat1b& mask, int levels);

/// Value and slope (a pixel of the whole image) at a position in the whole image, bilinear; inside the image only.
struct Spot {
  double value = 0;
  Eigen::RowVector2d slope = Eigen::RowVector2d::Zero();
};
Spot spot_at(const cv::Mat1f& level, const cv::Size& image, const Eigen::Vector2d& pixel);

}  // namespace dvi::align
