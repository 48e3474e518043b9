#include "dvi/odometry/thumbnail.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "dvi/geometry/angles.h"
#include "dvi/image/interpolate.h"

namespace dvi::odometry {
namespace {

constexpr double kThumbnailBlurPx = 1.2, kRollStepDeg = 8;
constexpr double kMaxShift = 0.5, kMinCommonShare = 0.35;  // fractions of the image

/// Returns the image that the camera would show after a roll about its optical axis; `known` marks pixels with a value.
cv::Mat1f roll_image(const Thumbnail& thumbnail, double roll, cv::Mat1b& known) {
  const cv::Mat1f& gray = thumbnail.gray;
  cv::Mat1f out(gray.size(), 0.0F);
  known = cv::Mat1b(gray.size(), uchar{0});
  const auto c = static_cast<float>(std::cos(roll)), s = static_cast<float>(std::sin(roll));
  for (int y = 0; y < gray.rows; ++y)
    for (int x = 0; x < gray.cols; ++x) {
      const float u = static_cast<float>(x) - thumbnail.camera.cx, v = static_cast<float>(y) - thumbnail.camera.cy;
      const cv::Point2f at(c * u + s * v + thumbnail.camera.cx, -s * u + c * v + thumbnail.camera.cy);
      if (at.x < 0 || at.y < 0 || at.x > static_cast<float>(gray.cols - 1) || at.y > static_cast<float>(gray.rows - 1))
        continue;
      out(y, x) = bilinear(gray, at);
      known(y, x) = 1;
    }
  return out;
}

/// The correlation of a(x + shift) and b(x) where both are known; -1 if they share too little.
double correlate(const cv::Mat1f& a, const cv::Mat1f& b, const cv::Mat1b& known, cv::Point shift) {
  double n = 0, sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0;
  for (int y = std::max(0, -shift.y); y < std::min(b.rows, a.rows - shift.y); ++y)
    for (int x = std::max(0, -shift.x); x < std::min(b.cols, a.cols - shift.x); ++x) {
      if (known(y, x) == 0) continue;
      const double p = a(y + shift.y, x + shift.x), q = b(y, x);
      n += 1, sum_a += p, sum_b += q, aa += p * p, bb += q * q, ab += p * q;
    }
  if (n < kMinCommonShare * static_cast<double>(b.total())) return -1;
  const double va = aa - sum_a * sum_a / n, vb = bb - sum_b * sum_b / n;
  return va > 1e-3 * n && vb > 1e-3 * n ? (ab - sum_a * sum_b / n) / std::sqrt(va * vb) : -1;
}

}  // namespace

Thumbnail make_thumbnail(const RgbdImage& image) {
  const RgbdLevel& coarsest = image.levels.back();
  Thumbnail out{coarsest.camera, coarsest.gray.clone()};
  if (out.gray.empty()) {
    out.gray = cv::Mat1f(coarsest.points.size(), 0.0F);
    for (int y = 0; y < out.gray.rows; ++y)
      for (int x = 0; x < out.gray.cols; ++x)
        if (const float z = coarsest.points(y, x)[2]; z > 0) out.gray(y, x) = 100 / z;
  }
  cv::GaussianBlur(out.gray, out.gray, {}, kThumbnailBlurPx);
  return out;
}

ThumbnailMatch match(const Thumbnail& a, const Thumbnail& b, double max_roll_deg) {
  ThumbnailMatch out;
  if (a.gray.size() != b.gray.size()) return out;
  const cv::Point max_shift(static_cast<int>(kMaxShift * a.gray.cols), static_cast<int>(kMaxShift * a.gray.rows));
  const int rolls = static_cast<int>(max_roll_deg / kRollStepDeg);
  for (int k = -rolls; k <= rolls; ++k) {
    const double roll = to_radians(k * kRollStepDeg);
    cv::Mat1b known;
    const cv::Mat1f rotated = roll_image(b, roll, known);
    cv::Point best;
    double found = -1;
    const auto attempt = [&](cv::Point shift) {
      if (const double value = correlate(a.gray, rotated, known, shift); value > found) found = value, best = shift;
    };
    for (int y = -max_shift.y; y <= max_shift.y; y += 2)
      for (int x = -max_shift.x; x <= max_shift.x; x += 2) attempt({x, y});
    const cv::Point middle = best;
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) attempt(middle + cv::Point(x, y));
    if (found <= out.correlation) continue;
    out.correlation = found;
    const double right = std::atan2(best.x, a.camera.fx), down = std::atan2(best.y, a.camera.fy);
    out.a_from_b = so3_exp({0, right, 0}) * so3_exp({-down, 0, 0}) * so3_exp({0, 0, roll});
  }
  return out;
}

}  // namespace dvi::odometry
