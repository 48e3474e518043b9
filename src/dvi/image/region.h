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

/// Dilates a mask by a disk (positive radius) or erodes it (negative); the radius is in pixels.
cv::Mat1b grown(const cv::Mat1b& mask, int radius);

/// Does the same at a cost that does not depend on the radius, with circles that deviate by a few percent.
cv::Mat1b grown_far(const cv::Mat1b& mask, int radius);

/// Labels the 4-connected parts of a mask from 1, with 0 outside. Returns their number.
int label_connected_parts(const cv::Mat1b& mask, cv::Mat1i& labels);

/// Returns the bounding box of a part, by the statistics of cv::connectedComponentsWithStats().
cv::Rect box_of_part(const cv::Mat1i& statistics, int part);

/// Returns the bounding boxes of the 8-connected parts of a mask.
std::vector<cv::Rect> find_part_boxes(const cv::Mat1b& mask);

}  // namespace dvi
