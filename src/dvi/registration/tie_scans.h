#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/registration/key_scans.h"

namespace dvi::registration {

/// A key scan of a drive as registered to those of drives that have their place.
struct Tie {
  std::size_t drive = 0, a = 0;  ///< the key scan that it was held against, and of which drive
  std::size_t b = 0;             ///< key scan of the drive itself
  SE3 a_from_b;
  Matrix6d information = Matrix6d::Zero();  ///< as in Registration
  double residual_m = 0;
};

/// Drives that have their place, in one world.
using PlacedKeys = std::vector<const KeyScans*>;

/// Registers the key scans of `keys` to the drives that have their place, outwards from key scan `first`, which lies at
/// `world_from_first`: each from where odometry puts it after the one before, while it sees enough of what they saw. `tick` is
/// called once a key scan.
std::vector<Tie> tie_scans(const PlacedKeys& placed, const KeyScans& keys, std::size_t first, const SE3& world_from_first,
                           const Tick& tick);

}  // namespace dvi::registration
