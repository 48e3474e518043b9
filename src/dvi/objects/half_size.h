#pragma once

#include <cstddef>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/core/cache_budget.h"

namespace dvi::objects {

/// Images of different times are compared at this fraction of their size, because poses have errors of about a pixel.
inline constexpr int kHalfSizeFactor = 2;

/// The image of a view at half size.
struct HalfSizeView {
  cv::Mat3b image;  ///< BGR
  cv::Mat1b mask;   ///< 255 where any of the pixels, or one of their neighbors, is masked

  std::size_t bytes() const { return bytes_of(image) + bytes_of(mask); }
};

/// Halves an image and its mask. The image is averaged over a square of `blur_px` pixels of half size; 1 means no blur.
HalfSizeView make_half_size_view(const cv::Mat3b& image, const cv::Mat1b& mask, int blur_px);

/// Converts a pixel of half size to the image coordinates of its center at full size.
Eigen::Vector2d to_full_size(cv::Point half);

/// Converts image coordinates at full size to image coordinates at half size.
cv::Point2f to_half_size(const Eigen::Vector2d& full);

}  // namespace dvi::objects
