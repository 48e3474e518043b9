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
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< meters, world axes
  float intensity = 0;
  std::uint32_t count = 0;                           ///< returns in it
  std::uint32_t first = 0, last = 0;                 ///< the scans that saw it first and last, in StaticMap::scans
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, toward the sensor that saw it first; zero: none found
  std::uint32_t absent = 0;                          ///< bits by drive_bit(): rays of these drives passed where it is

  /// Whether it stood there on the day of that drive, as far as is known.
  bool stood_on(std::size_t drive) const { return (absent & drive_bit(drive)) == 0; }
  /// Drives beyond the 31st share a bit.
  static constexpr std::uint32_t drive_bit(std::size_t drive) { return 1U << (drive < 31 ? drive : 31); }
};

/// A scan that the map is made of.
struct MapScan {
  std::size_t drive = 0;  ///< of the inputs
  std::int64_t time_ns = 0;
  Eigen::Vector3f sensor = Eigen::Vector3f::Zero();  ///< where it was in the middle of the scan, world axes
};

/// Why a return is not in the map although it was in range: it projects into a mask, lies in a labeled 3D box, or rays of
/// other scans of its drive passed through it.
enum class Cause : std::uint8_t { masked = 1, boxed = 2, moved = 3 };

/// What was removed, thinned as the map is.
struct RemovedPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  Cause cause = Cause::masked;
};

/// How many returns went where.
struct MapCounts {
  std::size_t returns = 0;           ///< all that were read
  std::size_t masked = 0;            ///< dropped: project into a mask
  std::size_t boxed = 0;             ///< dropped: inside a labeled 3D box
  std::size_t unseen_by_camera = 0;  ///< dropped by require_camera_visibility: no camera saw them unmasked when scanned
  std::size_t moved = 0;             ///< dropped: rays of other scans went through where they were
  std::size_t too_near = 0;          ///< dropped: the recording car itself
  std::size_t scans = 0, scans_without_pose = 0;
};

/// What never moved, in tiles so that a view can leave out what it cannot see.
struct StaticMap {
  struct Tile {
    Eigen::AlignedBox3f bounds;
    std::size_t first = 0, last = 0;  ///< its points: [first, last)
  };
  explicit StaticMap(const std::shared_ptr<Scratch>& scratch = {}) : points(scratch), removed(scratch) {}

  ScratchVector<MapPoint> points;
  std::vector<Tile> tiles;
  ScratchVector<RemovedPoint> removed;
  std::vector<MapScan> scans;
  MapCounts counts;

  std::shared_ptr<Scratch> scratch() const { return points.get_allocator().scratch; }  ///< may be none
  /// Lets what does not fit into memory leave it until it is looked at again.
  void page_out() const {
    if (scratch()) scratch()->page_out();
  }
};

}  // namespace dvi::map
