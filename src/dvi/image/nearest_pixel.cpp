#include "dvi/image/nearest_pixel.h"

#include <cstddef>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace dvi {

NearestPixel::NearestPixel(const cv::Mat1b& mask) {
  const int count = cv::countNonZero(mask);
  if (count == 0) return;
  cv::distanceTransform(cv::Mat1b(~mask), distance_px_, label_, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  pixels_.resize(static_cast<std::size_t>(count) + 1);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask(y, x) != 0) pixels_[static_cast<std::size_t>(label_(y, x))] = {x, y};
}

std::optional<cv::Point> NearestPixel::find(cv::Point pixel) const {
  if (pixels_.empty()) return std::nullopt;
  return pixels_[static_cast<std::size_t>(label_(pixel))];
}

std::optional<cv::Point> NearestPixel::find(cv::Point pixel, float max_distance_px) const {
  if (pixels_.empty() || distance_px_(pixel) > max_distance_px) return std::nullopt;
  return find(pixel);
}

}  // namespace dvi
