#pragma once

#include <cstddef>
#include <functional>

#include "dvi/core/lazy.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"

namespace dvi::depth {

/// Depth maps and visibility maps, computed on demand. Visibility maps are small and are cached for many source frames. Depth
/// maps are large and are used once. If a view of the target drive is first used as a source frame, its depth is packed and
/// stored, within a bound, until it is the target, so that it is computed once.
struct Depths {
  /// `make(view)` computes the depth map of a view.
  Depths(const Views& views, const std::function<DepthMap(std::size_t)>& make);

  std::function<DepthMap(std::size_t)> make_map;  ///< Makes the depth map of a view; `sigma` is 0 outside the mask.
  Lazy<VisibilityMap> visibility;                 ///< One per view.
};

}  // namespace dvi::depth
