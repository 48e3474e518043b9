#include "dvi/metrics/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/image/gray.h"
#include "dvi/image/interpolate.h"
#include "dvi/image/optical_flow.h"

namespace dvi::metrics {
namespace {

cv::Mat1d blur(const cv::Mat1d& image) {
  cv::Mat1d out;
  cv::GaussianBlur(image, out, {11, 11}, 1.5, 1.5, cv::BORDER_REFLECT);
  return out;
}

cv::Mat1d blur_product(const cv::Mat1d& a, const cv::Mat1d& b) {
  cv::Mat1d product;
  cv::multiply(a, b, product);
  return blur(product);
}

}  // namespace

double ErrorSums::mae() const { return static_cast<double>(absolute) / static_cast<double>(values); }

double ErrorSums::rmse() const { return std::sqrt(static_cast<double>(square) / static_cast<double>(values)); }

double ErrorSums::psnr() const {
  if (values == 0) return std::numeric_limits<double>::quiet_NaN();
  if (square == 0) return kMaxPsnr;
  return std::min(kMaxPsnr, 10 * std::log10(255.0 * 255.0 * static_cast<double>(values) / static_cast<double>(square)));
}

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) {
  absolute += other.absolute;
  square += other.square;
  values += other.values;
  return *this;
}

ErrorSums sum_errors(const cv::Mat3b& result, const cv::Mat3b& truth, const cv::Mat1b& pixels) {
  ErrorSums sums;
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x) {
      if (!pixels(y, x)) continue;
      for (int c = 0; c < 3; ++c) {
        const int d = std::abs(int{result(y, x)[c]} - int{truth(y, x)[c]});
        sums.absolute += static_cast<std::uint64_t>(d);
        sums.square += static_cast<std::uint64_t>(d) * static_cast<std::uint64_t>(d);
      }
      sums.values += 3;
    }
  return sums;
}

PixelSum& PixelSum::operator+=(const PixelSum& other) {
  sum += other.sum;
  count += other.count;
  return *this;
}

PixelSum sum_over(const cv::Mat1f& map, const cv::Mat1b& pixels) {
  PixelSum out;
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x) {
      if (!pixels(y, x) || std::isnan(map(y, x))) continue;
      out.sum += double{map(y, x)};
      ++out.count;
    }
  return out;
}

cv::Mat1d to_gray(const cv::Mat3b& image) {
  cv::Mat1d out(image.size());
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec3b& p = image(y, x);
      out(y, x) = 0.299 * p[2] + 0.587 * p[1] + 0.114 * p[0];
    }
  return out;
}

cv::Mat1f compute_ssim(const cv::Mat3b& a, const cv::Mat3b& b) {
  constexpr double kC1 = 0.01 * 255 * 0.01 * 255, kC2 = 0.03 * 255 * 0.03 * 255;
  const cv::Mat1d ga = to_gray(a), gb = to_gray(b);
  const cv::Mat1d mean_a = blur(ga), mean_b = blur(gb);
  const cv::Mat1d square_a = blur_product(ga, ga), square_b = blur_product(gb, gb), product = blur_product(ga, gb);
  cv::Mat1f map(a.size());
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const double ma = mean_a(y, x), mb = mean_b(y, x);
      const double variance_a = square_a(y, x) - ma * ma, variance_b = square_b(y, x) - mb * mb;
      const double covariance = product(y, x) - ma * mb;
      map(y, x) = static_cast<float>((2 * ma * mb + kC1) * (2 * covariance + kC2) /
                                     ((ma * ma + mb * mb + kC1) * (variance_a + variance_b + kC2)));
    }
  return map;
}

cv::Mat1f compute_gradient(const cv::Mat3b& image) {
  cv::Mat1f g;
  to_gray(image).convertTo(g, CV_32F);
  cv::Mat1f dx, dy, length;
  cv::Sobel(g, dx, CV_32F, 1, 0, 1, 0.5);
  cv::Sobel(g, dy, CV_32F, 0, 1, 1, 0.5);
  cv::magnitude(dx, dy, length);
  return length;
}

cv::Mat1f compute_change(const cv::Mat3b& now, const cv::Mat3b& before, const cv::Mat2f& before_from_now,
                         const cv::Mat1b& pixels) {
  cv::Mat1f change(now.size(), std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < now.rows; ++y)
    for (int x = 0; x < now.cols; ++x) {
      if (!pixels(y, x)) continue;
      const cv::Vec2f& motion = before_from_now(y, x);
      const cv::Point2f at(static_cast<float>(x) + motion[0], static_cast<float>(y) + motion[1]);
      const bool inside =
          at.x >= 0 && at.y >= 0 && at.x <= static_cast<float>(before.cols - 1) && at.y <= static_cast<float>(before.rows - 1);
      if (!inside) continue;
      const cv::Vec3f was = bilinear(before, at);
      float sum = 0;
      for (int c = 0; c < 3; ++c) sum += std::abs(static_cast<float>(now(y, x)[c]) - was[c]);
      change(y, x) = sum / 3;
    }
  return change;
}

cv::Mat1f compute_position_error(const cv::Mat3b& result, const cv::Mat3b& truth, const cv::Mat1b& pixels) {
  cv::Mat3b anchored = truth.clone();
  result.copyTo(anchored, pixels);
  const cv::Mat2f flow = compute_optical_flow(gray_8bit(truth), gray_8bit(anchored));
  cv::Mat1f length(flow.size());
  for (int y = 0; y < flow.rows; ++y)
    for (int x = 0; x < flow.cols; ++x) length(y, x) = std::hypot(flow(y, x)[0], flow(y, x)[1]);
  return length;
}

}  // namespace dvi::metrics
