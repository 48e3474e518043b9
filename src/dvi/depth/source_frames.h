#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/depth/target.h"

namespace dvi::depth {

/// Rays of the target's camera (camera axes, depth 1), and the largest inverse depth at which a surface may lie on them.
struct SearchRays {
  const std::vector<Eigen::Vector3d>& rays;
  double nearest;
};

/// The views, at most `count`, that together show most of the target's pixels along the rays, from inverse depth `nearest` to
/// infinity, each pixel by several: from among near and ever farther ones in time, to either side, up to `max_frame_gap` frames
/// away, and the nearest ones of other drives.
std::vector<std::size_t> choose_source_frames(const Target& target, const SearchRays& search, int count, int max_frame_gap);

}  // namespace dvi::depth
