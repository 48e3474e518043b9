#pragma once

#include <cstddef>
#include <functional>

#include "dvi/core/lazy.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"

namespace dvi::depth {

/// Depth maps and visibility maps, made on demand. Visibility maps are small and cached for many source frames. Depth maps
/// are cached only for the frames in progress, so that memory stays bounded. A view of the target drive that is first used as
/// a source frame keeps its depth, packed and within a bound, until its own turn, so that it is computed once.
struct Depths {
  /// `make`: the depth map of a view.
  Depths(const Views& views, const std::function<DepthMap(std::size_t)>& make);

  Lazy<DepthMap> maps;             ///< as views; sigma is 0 outside the mask
  Lazy<VisibilityMap> visibility;  ///< as views
};

}  // namespace dvi::depth
