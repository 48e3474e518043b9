#pragma once

#include <cstddef>
#include <functional>

#include <opencv2/core/mat.hpp>

#include "dvi/core/lazy.h"
#include "dvi/drive/outline.h"

namespace dvi::objects {

/// Masks that are made once: one that the shared budget drops is drawn again from its outline, some kilobytes that are always
/// kept.
inline Lazy<cv::Mat1b> kept_masks(std::size_t count, const std::function<cv::Mat1b(std::size_t)>& make) {
  const Lazy<Instance> outlines(count, count, [make](std::size_t i) { return to_outline(make(i)); });
  return {count, [outlines](std::size_t i) {
            const auto outline = outlines[i];
            cv::Mat1b mask(outline->size, uchar{0});
            draw(*outline, mask);
            return mask;
          }};
}

}  // namespace dvi::objects
