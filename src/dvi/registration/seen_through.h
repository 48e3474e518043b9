#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "dvi/registration/key_scans.h"

namespace dvi::registration {

/// What the rays of one drive say of what another saw standing.
struct RayVotes {
  std::size_t hit = 0;     ///< points where they ended, too
  std::size_t passed = 0;  ///< points that they went through: not there

  /// Of what they could see.
  double passed_share() const { return hit + passed > 0 ? static_cast<double>(passed) / static_cast<double>(hit + passed) : 0; }
};

/// Points in the world of `keys`, as its scans up to 12 m before and after one see them (drive/free_space.h). Cars that have
/// left and leaves that have fallen are passed through in the right place, too.
RayVotes sight(const KeyScans& keys, std::size_t key, const std::vector<Eigen::Vector3d>& world);

}  // namespace dvi::registration
