#pragma once

#include <cstddef>
#include <functional>

#include "dvi/core/lazy.h"
#include "dvi/depth/depth_map.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"

namespace dvi::depth {

/// Depth on demand. Of source frames only the visibility map is asked for, which is small and kept for many of them; of
/// whole depth maps only those of the frames in work are kept, so that memory stays flat. A view of the target drive that is
/// asked as a source first keeps its depth, packed and within a bound, until its own turn comes: it is made once.
struct Depths {
  /// `make`: the depth map of a view.
  Depths(const Views& views, const std::function<DepthMap(std::size_t)>& make);

  Lazy<DepthMap> maps;             ///< as views; of those of the target drive, sigma within the mask only
  Lazy<VisibilityMap> visibility;  ///< as views
};

}  // namespace dvi::depth
