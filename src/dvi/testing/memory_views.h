#pragma once

#include <utility>
#include <vector>

#include "dvi/drive/view.h"

namespace dvi {

/// Makes views whose images and masks are in memory.
inline Views memory_views(std::vector<View> views, const std::vector<cv::Mat3b>& images, const std::vector<cv::Mat1b>& masks) {
  const std::size_t n = views.size();
  return {std::move(views), Lazy<cv::Mat3b>(n, n, [images](std::size_t i) { return images[i]; }),
          Lazy<cv::Mat1b>(n, n, [masks](std::size_t i) { return masks[i]; })};
}

}  // namespace dvi
