#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi {

/// Finds the nearest of the pixels that are 255 in a mask.
class NearestPixel {
 public:
  explicit NearestPixel(const cv::Mat1b& mask);

  /// Returns the one nearest to a pixel; nothing if the mask is empty.
  std::optional<cv::Point> find(cv::Point pixel) const;
  /// Returns the same if it is within a distance.
  std::optional<cv::Point> find(cv::Point pixel, float max_distance_px) const;

 private:
  cv::Mat1f distance_px_;
  cv::Mat1i label_;
  std::vector<cv::Point> pixels_;  // by label
};

}  // namespace dvi
