#pragma once

#include <opencv2/core/types.hpp>

namespace dvi {

/// Enlarges a box by `margin_px` on all sides, within an image.
inline cv::Rect enlarge_box(const cv::Rect& box, int margin_px, cv::Size image) {
  const cv::Point margin(margin_px, margin_px);
  return cv::Rect(box.tl() - margin, box.br() + margin) & cv::Rect({}, image);
}

}  // namespace dvi
