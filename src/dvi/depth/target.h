#pragma once

#include <cstddef>
#include <memory>

#include "dvi/core/lazy.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"

namespace dvi::depth {

/// A frame whose hole is filled, together with the data of it and of its source frames that all stages from the plane sweep on
/// read. It holds references only, and is constructed for one call.
struct Target {
  const Views& views;                     ///< All views of all drives: the frame itself and its source frames.
  std::size_t index;                      ///< The index of the frame in `views`.
  const DepthMap& depth;                  ///< The depth of the frame.
  const Lazy<VisibilityMap>& visibility;  ///< One per view; computed only for views that may show a pixel of the frame.

  const View& view() const { return views[index]; }
  std::shared_ptr<const cv::Mat3b> image() const { return views.images[index]; }
  std::shared_ptr<const cv::Mat1b> mask() const { return views.masks[index]; }
};

}  // namespace dvi::depth
