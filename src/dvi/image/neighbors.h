#pragma once

#include <array>

#include <opencv2/core/types.hpp>

namespace dvi {

/// The 4-neighborhood of a pixel: left, above, right, and below. The neighbors of a border pixel may lie outside of the image.
inline std::array<cv::Point, 4> four_neighbors(cv::Point p) {
  return {p + cv::Point(-1, 0), p + cv::Point(0, -1), p + cv::Point(1, 0), p + cv::Point(0, 1)};
}

}  // namespace dvi
