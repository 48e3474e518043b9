#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/interrupt.h"
#include "dvi/objects/completion/masked_returns.h"

namespace dvi::objects {

/// A cube of space that a removed object occupied for a time.
struct OccupiedVoxel {
  Eigen::Vector3i index;                ///< position divided by the edge of the voxels, rounded down
  std::int64_t first_ns = 0;            ///< the object may have been there from this time ...
  std::int64_t last_ns = 0;             ///< ... to this time
  std::int64_t first_return_ns = 0;     ///< time of the first scan with a return there
  std::int64_t last_return_ns = 0;      ///< time of the last one
  std::vector<std::uint32_t> returns;   ///< scans with a return there, ascending
  std::vector<std::uint32_t> evidence;  ///< those among them in which masks show the object there, ascending
  int object = -1;                      ///< number of the object

  Eigen::Vector3d center() const;
};

inline constexpr double kObjectVoxelM = 0.25;  ///< edge of the voxels; a car has about 300 on each side
inline constexpr double kJudgedRadiusM = 0.1;  ///< around the center of a voxel that a scan must pass to observe it as free

/// Returns the index of the voxel at a position in world axes.
inline Eigen::Vector3i voxel_at(const Eigen::Vector3d& world) { return (world / kObjectVoxelM).array().floor().cast<int>(); }

/// Finds the space that removed objects occupied (masks as evidence of objects). A voxel is occupied from the time before
/// which, to the time after which, scans observe it as free. It belongs to an object for all of this time if masks show an
/// object there in at least one scan and background in few. Neighboring voxels that are occupied at the same time belong to one
/// object. Objects that masks show in one scan only are left out, because single masks may be wrong. `cameras` are those of the
/// drive of `returns`. Calls `tick` once per scan.
std::vector<OccupiedVoxel> find_object_space(const std::vector<CameraMaskEvidence>& cameras, const MovingReturns& returns,
                                             const Tick& tick);

}  // namespace dvi::objects
