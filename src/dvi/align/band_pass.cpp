#include "dvi/align/band_pass.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "dvi/image/gray.h"

namespace dvi::align {
namespace {

/// Blurs with weights: masked pixels have weight 0.
cv::Mat1f blur_weighted(const cv::Mat1f& weighted, const cv::Mat1f& weight, double sigma) {
  cv::Mat1f above, below;
  cv::GaussianBlur(weighted, above, {}, sigma);
  cv::GaussianBlur(weight, below, {}, sigma);
  cv::divide(above, below + 1e-6F, above);
  return above;
}

float interpolate_value(const cv::Mat1f& image, double x, double y) {
  const int x0 = std::clamp(static_cast<int>(x), 0, image.cols - 2), y0 = std::clamp(static_cast<int>(y), 0, image.rows - 2);
  const float u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
  const float *top = image[y0] + x0, *bottom = image[y0 + 1] + x0;
  return (top[0] * (1 - u) + top[1] * u) * (1 - v) + (bottom[0] * (1 - u) + bottom[1] * u) * v;
}

}  // namespace

BandPass make_band_pass(const cv::Mat3b& image, const cv::Mat1b& mask, int levels) {
  cv::Mat1f brightness, weight;
  gray_8bit(image).convertTo(brightness, CV_32F, 1, kBandPass.dark);
  cv::log(brightness, brightness);
  cv::Mat1b(mask == 0).convertTo(weight, CV_32F, 1.0 / 255);
  cv::Mat1f weighted;
  cv::multiply(brightness, weight, weighted);
  BandPass out;
  for (int l = 0;; ++l) {
    out.emplace_back(blur_weighted(weighted, weight, kBandPass.fine_px) - blur_weighted(weighted, weight, kBandPass.coarse_px));
    if (l + 1 >= levels) return out;
    const cv::Size half((weighted.cols + 1) / 2, (weighted.rows + 1) / 2);
    cv::resize(weighted, weighted, half, 0, 0, cv::INTER_AREA);
    cv::resize(weight, weight, half, 0, 0, cv::INTER_AREA);
  }
}

ValueAndSlope sample(const cv::Mat1f& level, const cv::Size& image, const Eigen::Vector2d& pixel) {
  const double sx = static_cast<double>(level.cols) / image.width, sy = static_cast<double>(level.rows) / image.height;
  const double x = std::clamp((pixel.x() + 0.5) * sx - 0.5, 1.0, level.cols - 2.0);
  const double y = std::clamp((pixel.y() + 0.5) * sy - 0.5, 1.0, level.rows - 2.0);
  return {interpolate_value(level, x, y),
          {0.5 * sx * (interpolate_value(level, x + 1, y) - interpolate_value(level, x - 1, y)),
           0.5 * sy * (interpolate_value(level, x, y + 1) - interpolate_value(level, x, y - 1))}};
}

}  // namespace dvi::align
