#pragma once

#include <cstddef>
#include <functional>

#include "dvi/core/lazy.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"

namespace dvi::depth {

/// Depth on demand. As sources, views are asked only for what they can lend, which is small, so that many stay in the caches.
struct Depths {
  /// `make`: the depth map of a view.
  Depths(const Views& views, int mask_margin_px, const std::function<DepthMap(std::size_t)>& make);

  Lazy<DepthMap> maps;             ///< as views
  Lazy<VisibilityMap> visibility;  ///< as views
};

}  // namespace dvi::depth
