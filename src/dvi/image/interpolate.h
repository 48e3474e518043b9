#pragma once

#include <algorithm>
#include <cmath>

#include <opencv2/core/mat.hpp>

namespace dvi {

/// The number of positions per pixel. Image coordinates are rounded to them, so that a written position reproduces its color
/// exactly.
inline constexpr float kSubpixel = 16.0F;

inline cv::Point2f quantize(double x, double y) {
  return {static_cast<float>(std::floor(x * kSubpixel + 0.5)) / kSubpixel,
          static_cast<float>(std::floor(y * kSubpixel + 0.5)) / kSubpixel};
}

/// Interpolates the color at a position within [0, width - 1] x [0, height - 1] bilinearly.
inline cv::Vec3f bilinear(const cv::Mat3b& image, cv::Point2f at) {
  const int x = std::clamp(static_cast<int>(at.x), 0, image.cols - 1), x1 = std::min(x + 1, image.cols - 1);
  const int y = std::clamp(static_cast<int>(at.y), 0, image.rows - 1), y1 = std::min(y + 1, image.rows - 1);
  const float u = at.x - static_cast<float>(x), v = at.y - static_cast<float>(y);
  const cv::Vec3b *top = image[y], *bottom = image[y1];
  cv::Vec3f out;
  for (int c = 0; c < 3; ++c) {
    const float a = static_cast<float>(top[x][c]) * (1 - u) + static_cast<float>(top[x1][c]) * u;
    const float b = static_cast<float>(bottom[x][c]) * (1 - u) + static_cast<float>(bottom[x1][c]) * u;
    out[c] = a * (1 - v) + b * v;
  }
  return out;
}

/// Does the same for an image of floats or of vectors of floats.
template <class Pixel>
Pixel bilinear(const cv::Mat_<Pixel>& image, cv::Point2f at) {
  const int x = static_cast<int>(at.x), x1 = std::min(x + 1, image.cols - 1);
  const int y = static_cast<int>(at.y), y1 = std::min(y + 1, image.rows - 1);
  const float u = at.x - static_cast<float>(x), v = at.y - static_cast<float>(y);
  return (image(y, x) * (1 - u) + image(y, x1) * u) * (1 - v) + (image(y1, x) * (1 - u) + image(y1, x1) * u) * v;
}

/// Averages width x height bilinear samples, one pixel apart, around a position; all must be within the image. It is the color
/// of a target pixel that covers so many pixels of the image.
inline cv::Vec3f box_mean(const cv::Mat3b& image, cv::Point2f at, cv::Vec2b footprint) {
  const int width = footprint[0], height = footprint[1];
  if (width == 1 && height == 1) return bilinear(image, at);
  const cv::Point2f first = at - 0.5F * cv::Point2f(static_cast<float>(width - 1), static_cast<float>(height - 1));
  cv::Vec3f sum;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) sum += bilinear(image, first + cv::Point2f(static_cast<float>(x), static_cast<float>(y)));
  return sum / static_cast<float>(width * height);
}

}  // namespace dvi
