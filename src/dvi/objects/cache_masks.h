#pragma once

#include <cstddef>
#include <functional>

#include <opencv2/core/mat.hpp>

#include "dvi/core/lazy.h"
#include "dvi/drive/outline.h"

namespace dvi::objects {

/// Makes masks on demand, each once. A mask that the shared budget drops is drawn again from its outline, which takes some
/// kilobytes and is always in memory.
inline Lazy<cv::Mat1b> cache_masks(std::size_t count, const std::function<cv::Mat1b(std::size_t)>& make) {
  const Lazy<Instance> outlines(count, count, [make](std::size_t i) { return to_outline(make(i)); });
  return {count, [outlines](std::size_t i) {
            const auto outline = outlines[i];
            cv::Mat1b mask(outline->size, uchar{0});
            draw(*outline, mask);
            return mask;
          }};
}

}  // namespace dvi::objects
