#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi {

/// The pixels of a mask, numbered in raster order.
struct Region {
  Region() = default;
  explicit Region(const cv::Mat1b& mask);

  std::vector<cv::Point> pixels;
  cv::Mat1i index;  ///< number of each pixel of the image, -1 outside the region

  std::size_t size() const { return pixels.size(); }
};

/// The mask grown by a disc (positive radius) or shrunk by it (negative), radius in pixels.
cv::Mat1b grown(const cv::Mat1b& mask, int radius);

/// 4-connected parts of a mask: labels 1..count, 0 outside.
int connected_parts(const cv::Mat1b& mask, cv::Mat1i& labels);

/// The bounding boxes of the 8-connected parts of a mask.
std::vector<cv::Rect> part_boxes(const cv::Mat1b& mask);

}  // namespace dvi
