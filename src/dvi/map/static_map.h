#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "dvi/core/scratch.h"

namespace dvi::map {

/// A point of the static scene: the mean of the returns of one voxel.
struct MapPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< meters, in the world
  float intensity = 0;
  std::uint32_t count = 0;                           ///< returns in the voxel
  std::uint32_t first = 0, last = 0;                 ///< indices in StaticMap::scans of its first and last scan
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit vector toward the sensor of its first scan; zero if unknown
  std::uint32_t absent = 0;                          ///< drive_bit() of the drives whose rays passed through it

  /// Returns whether the point was present during that drive, as far as is known.
  bool is_present_in(std::size_t drive) const { return (absent & drive_bit(drive)) == 0; }
  /// Returns the bit of a drive. Drives beyond the 31st share one bit.
  static constexpr std::uint32_t drive_bit(std::size_t drive) { return 1U << (drive < 31 ? drive : 31); }
};

/// A scan of the map.
struct MapScan {
  std::size_t drive = 0;  ///< index of the input
  std::int64_t time_ns = 0;
  Eigen::Vector3f sensor = Eigen::Vector3f::Zero();  ///< position at the middle of the scan, in the world
};

/// The reason why a return in range is not in the map: it projects into a mask, is in a labeled 3D box, or was passed by rays
/// of other scans of its drive.
enum class Cause : std::uint8_t { masked = 1, boxed = 2, moved = 3 };

/// A removed point; removed points are thinned like the map.
struct RemovedPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Cause cause = Cause::masked;
};

/// The number of returns by outcome.
struct MapCounts {
  std::size_t returns = 0;           ///< all returns that were read
  std::size_t masked = 0;            ///< dropped: they project into a mask
  std::size_t boxed = 0;             ///< dropped: in a labeled 3D box
  std::size_t unseen_by_camera = 0;  ///< dropped by require_camera_visibility: no camera observed them
  std::size_t moved = 0;             ///< dropped: rays of other scans passed through them
  std::size_t too_near = 0;          ///< dropped: out of range, for example on the ego vehicle
  std::size_t scans = 0, scans_without_pose = 0;

  MapCounts& operator+=(const MapCounts& more) {
    returns += more.returns;
    masked += more.masked;
    boxed += more.boxed;
    unseen_by_camera += more.unseen_by_camera;
    moved += more.moved;
    too_near += more.too_near;
    scans += more.scans;
    scans_without_pose += more.scans_without_pose;
    return *this;
  }
};

/// The static points, in tiles, so that a view can skip tiles outside it.
struct StaticMap {
  struct Tile {
    Eigen::AlignedBox3f bounds;
    std::size_t first = 0, last = 0;  ///< range of its points: [first, last)
  };
  explicit StaticMap(const std::shared_ptr<Scratch>& scratch = {}) : points(scratch), removed(scratch) {}

  ScratchVector<MapPoint> points;
  std::vector<Tile> tiles;
  ScratchVector<RemovedPoint> removed;
  std::vector<MapScan> scans;
  MapCounts counts;

  std::shared_ptr<Scratch> scratch() const { return points.get_allocator().scratch; }  ///< may be null
  /// Moves data beyond the memory bound to disk until it is used again.
  void page_out() const {
    if (scratch()) scratch()->page_out();
  }
};

}  // namespace dvi::map
