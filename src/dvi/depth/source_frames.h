#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/depth/target.h"

namespace dvi::depth {

/// Rays of the target's camera along which surfaces are searched.
struct SearchRays {
  const std::vector<Eigen::Vector3d>& rays;  ///< Directions in camera axes, with z = 1.
  double max_inverse_depth;                  ///< The inverse depth of the nearest surface, in 1/m.
};

/// Selects at most `count` source frames that together observe the points on the rays, from the largest inverse depth to
/// infinity, each point several times. Candidates are frames of the target's drive up to `max_frame_gap` before and after, with
/// growing distance in time, frames of its other cameras, and the nearest frames of other drives.
std::vector<std::size_t> choose_source_frames(const Target& target, const SearchRays& search, int count, int max_frame_gap);

}  // namespace dvi::depth
