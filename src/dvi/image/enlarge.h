#pragma once

#include <opencv2/core/types.hpp>

namespace dvi {

/// Enlarges a rectangle by a border on all sides, within an image. An empty one stays empty.
inline cv::Rect enlarge(const cv::Rect& rect, int border_px, cv::Size image) {
  if (rect.empty()) return rect;
  return cv::Rect(rect.x - border_px, rect.y - border_px, rect.width + 2 * border_px, rect.height + 2 * border_px) &
         cv::Rect({}, image);
}

}  // namespace dvi
