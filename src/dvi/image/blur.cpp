#include "dvi/image/blur.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dvi {
namespace {

/// The blocks along one side of an image.
struct Blocks {
  int count;
  double sigma;  // in blocks

  Blocks(int pixels, double sigma_px) : count(pixels), sigma(sigma_px) {
    constexpr double kMinSigmaBlocks = 2.5;  // the image is smooth between the blocks of a Gaussian
    if (sigma_px < 2 * kMinSigmaBlocks) return;
    count = static_cast<int>(std::ceil(pixels * kMinSigmaBlocks / sigma_px));
    // Means over blocks have a variance of 1 / 12, and linear interpolation between them has twice that.
    const double width = static_cast<double>(pixels) / count;
    sigma = std::sqrt(sigma_px * sigma_px / (width * width) - 0.25);
  }
};

}  // namespace

cv::Mat blurred(const cv::Mat& image, double sigma_x, double sigma_y) {
  const Blocks x(image.cols, sigma_x), y(image.rows, sigma_y);
  const cv::Size size(x.count, y.count);
  cv::Mat means, out;
  cv::resize(image, means, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(means, means, {}, x.sigma, y.sigma, cv::BORDER_REFLECT);
  cv::resize(means, out, image.size(), 0, 0, cv::INTER_LINEAR);
  return out;
}

}  // namespace dvi
