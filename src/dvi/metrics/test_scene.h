#pragma once

#include <cmath>

#include <opencv2/core/mat.hpp>

namespace dvi::metrics {

/// A textured image whose content is shifted to the right.
inline cv::Mat3b make_scene(cv::Size size, double shift_px) {
  cv::Mat3b image(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double u = x - shift_px;
      const double v = 128 + 40 * std::sin(0.31 * u + 0.12 * y) + 35 * std::sin(0.47 * y - 0.11 * u + 1) +
                       25 * std::sin(0.071 * u * std::cos(0.02 * u) + 0.19 * y);
      image(y, x) = cv::Vec3b(static_cast<uchar>(v), static_cast<uchar>(v + 10), static_cast<uchar>(v - 10));
    }
  return image;
}

}  // namespace dvi::metrics
