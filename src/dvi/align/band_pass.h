#pragma once

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace dvi::align {

/// Parameters of the band-pass filter.
struct BandPassParams {
  double fine_px = 1;    ///< smaller blur, in pixels of the level; finer details are noise
  double coarse_px = 4;  ///< larger blur; coarser differences are illumination
  double dark = 8;       ///< offset in gray levels, which limits the noise of dark pixels
};
inline constexpr BandPassParams kBandPass;

/// The texture of an image without its illumination: the difference of two blurs of the logarithm of its brightness, which
/// removes a gain of the whole frame or a gain that changes slowly across it. Masked pixels do not contribute. Level l is the
/// image at 1 / 2^l of its size.
using BandPass = std::vector<cv::Mat1f>;
BandPass make_band_pass(const cv::Mat3b& image, const cv::Mat1b& mask, int levels);

/// The value and the slope per pixel of the full image.
struct ValueAndSlope {
  double value = 0;
  Eigen::RowVector2d slope = Eigen::RowVector2d::Zero();
};
/// Interpolates bilinearly at a position in the full image, which must be within the image.
ValueAndSlope sample(const cv::Mat1f& level, const cv::Size& image, const Eigen::Vector2d& pixel);

}  // namespace dvi::align
