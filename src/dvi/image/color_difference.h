#pragma once

#include <algorithm>
#include <cmath>

#include <opencv2/core/matx.hpp>

namespace dvi {

/// Returns the largest difference of two colors over the channels.
inline float max_difference(const cv::Vec3f& a, const cv::Vec3f& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

/// Returns the mean difference of two colors over the channels.
inline float mean_difference(const cv::Vec3f& a, const cv::Vec3f& b) {
  return (std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2])) / 3;
}

}  // namespace dvi
