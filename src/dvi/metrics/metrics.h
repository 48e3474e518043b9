#pragma once

#include <cstddef>
#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace dvi::metrics {

/// Differences of a result to the truth over some pixels, three channels each, in gray levels 0..255. Sums are whole
/// numbers: they may be added in any order.
struct ErrorSums {
  std::uint64_t absolute = 0, square = 0, values = 0;

  double mae() const;
  double rmse() const;
  double psnr() const;  ///< 10 log10(255^2 / MSE), at most kMostPsnr
  ErrorSums& operator+=(const ErrorSums& other);
};

/// What an exact frame counts as, in dB: a mean over frames needs a number there.
inline constexpr double kMostPsnr = 100;

ErrorSums error_sums(const cv::Mat3b& result, const cv::Mat3b& truth, const cv::Mat1b& pixels);

/// A sum over pixels, and of how many.
struct PixelSum {
  double sum = 0;
  std::size_t count = 0;

  double mean() const { return sum / static_cast<double>(count); }  ///< NaN where there are no pixels
  PixelSum& operator+=(const PixelSum& other);
};

/// The map's values over the pixels of a mask; those that are NaN do not count.
PixelSum sum_over(const cv::Mat1f& map, const cv::Mat1b& pixels);

/// Gray by ITU-R BT.601, 0..255, not rounded.
cv::Mat1d gray(const cv::Mat3b& image);

/// Structural similarity (Wang et al., 2004) of the gray images at each pixel: Gaussian window of sigma 1.5 (11 x 11), K1
/// 0.01, K2 0.03, L 255, borders mirrored. As scikit-image's structural_similarity with gaussian_weights=True, sigma=1.5,
/// use_sample_covariance=False, data_range=255.
cv::Mat1f ssim_map(const cv::Mat3b& a, const cv::Mat3b& b);

/// Length of the gray image's gradient by central differences, gray levels a pixel.
cv::Mat1f gradient_magnitude(const cv::Mat3b& image);

/// How much each pixel changed along the motion: |now(p) - before(p + flow(p))|, mean of the three channels, bilinear.
/// Outside `pixels`, and where the motion leaves the image: NaN.
cv::Mat1f change_along(const cv::Mat3b& now, const cv::Mat3b& before, const cv::Mat2f& before_from_now,
                       const cv::Mat1b& pixels);

/// How far the result's content lies from where it should: length of the optical flow from truth to result, in pixels. Only
/// `pixels` are taken from the result, so that their surroundings anchor the flow.
cv::Mat1f misplacement(const cv::Mat3b& result, const cv::Mat3b& truth, const cv::Mat1b& pixels);

}  // namespace dvi::metrics
