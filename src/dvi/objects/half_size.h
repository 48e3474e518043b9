#pragma once

#include <cstddef>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"

namespace dvi::objects {

/// Images of different times are compared at half their size: poses are good to a pixel or so.
inline constexpr int kScale = 2;

using Patch = cv::Mat_<cv::Vec3f>;

/// A view's image at half size.
struct HalfView {
  Patch image;
  cv::Mat1b mask;  ///< 255 where any of the pixels, or one beside them, is masked

  std::size_t bytes() const { return bytes_of(image) + bytes_of(mask); }
};

/// `blur`: pixels of half size across that are averaged; 1: none.
HalfView half_view(const cv::Mat3b& image, const cv::Mat1b& mask, int blur);

/// Where the middle of a pixel of half size lies in the image, and back.
Eigen::Vector2d full_size(cv::Point half);
cv::Point2f half_size(const Eigen::Vector2d& full);

}  // namespace dvi::objects
