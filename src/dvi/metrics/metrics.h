#pragma once

#include <cstddef>
#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace dvi::metrics {

/// The differences of a result from the truth over a set of pixels with three channels, in gray levels 0..255. Sums are
/// integers, so that the order of additions does not matter.
struct ErrorSums {
  std::uint64_t absolute = 0, square = 0, values = 0;

  double mae() const;
  double rmse() const;
  double psnr() const;  ///< 10 log10(255^2 / MSE), at most kMaxPsnr
  ErrorSums& operator+=(const ErrorSums& other);
};

/// The PSNR in dB of an exact frame, so that means over frames are finite.
inline constexpr double kMaxPsnr = 100;

/// Sums the errors of the pixels that `pixels` marks with nonzero values. All images have the same size.
ErrorSums sum_errors(const cv::Mat3b& result, const cv::Mat3b& truth, const cv::Mat1b& pixels);

/// A sum over pixels, and their number.
struct PixelSum {
  double sum = 0;
  std::size_t count = 0;

  double mean() const { return sum / static_cast<double>(count); }  ///< NaN if there are no pixels
  PixelSum& operator+=(const PixelSum& other);
};

/// Sums the values of a map over the pixels of a mask; NaN values do not count.
PixelSum sum_over(const cv::Mat1f& map, const cv::Mat1b& pixels);

/// Converts to gray by ITU-R BT.601, 0..255, without rounding.
cv::Mat1d to_gray(const cv::Mat3b& image);

/// Computes the structural similarity (Wang et al., 2004) of the gray images at each pixel: Gaussian window of sigma 1.5 (11 x
/// 11), K1 0.01, K2 0.03, L 255, mirrored borders. Agrees with scikit-image's structural_similarity with gaussian_weights=True,
/// sigma=1.5, use_sample_covariance=False, data_range=255.
cv::Mat1f compute_ssim(const cv::Mat3b& a, const cv::Mat3b& b);

/// Computes the length of the gradient of the gray image by central differences, in gray levels per pixel.
cv::Mat1f compute_gradient(const cv::Mat3b& image);

/// Computes the change of each pixel along the motion: |now(p) - before(p + flow(p))|, mean of the three channels, bilinear.
/// NaN outside `pixels` and where the motion leaves the image.
cv::Mat1f compute_change(const cv::Mat3b& now, const cv::Mat3b& before, const cv::Mat2f& before_from_now,
                         const cv::Mat1b& pixels);

/// Computes the position error of the content of the result: the length of the optical flow from the truth to the result, in
/// pixels. Only `pixels` are taken from the result, so that the pixels around them constrain the flow.
cv::Mat1f compute_position_error(const cv::Mat3b& result, const cv::Mat3b& truth, const cv::Mat1b& pixels);

}  // namespace dvi::metrics
