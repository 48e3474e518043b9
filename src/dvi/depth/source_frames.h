#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/lazy.h"
#include "dvi/depth/visibility_map.h"
#include "dvi/drive/view.h"

namespace dvi::depth {

/// The views, at most `count`, that together show most of the target's pixels along `rays` (depth 1, camera axes), from where
/// they are at inverse depth `nearest` to infinity, each pixel by several: from among near and ever farther ones in time, to
/// either side, and the nearest ones of other drives.
std::vector<std::size_t> choose_source_frames(const Views& views, std::size_t target, const std::vector<Eigen::Vector3d>& rays,
                                              double nearest, const Lazy<depth::VisibilityMap>& visibility, int count,
                                              int max_frame_gap);

}  // namespace dvi::depth
