#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace dvi {

/// A point of the static scene: the mean of the returns of one voxel.
struct MapPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres, world axes
  float intensity = 0;
  std::uint32_t count = 0;  ///< returns in it
};

/// How many returns went where.
struct MapCounts {
  std::size_t returns = 0;      ///< all that were read
  std::size_t masked = 0;       ///< dropped: project into a mask
  std::size_t boxed = 0;        ///< dropped: inside a labelled 3D box
  std::size_t unwitnessed = 0;  ///< dropped: no camera saw them, unmasked, when they were scanned
  std::size_t too_near = 0;     ///< dropped: the recording car itself
  std::size_t sweeps = 0, sweeps_without_pose = 0;
};

/// What never moved, in tiles so that a view can leave out what it cannot see.
struct StaticMap {
  struct Tile {
    Eigen::AlignedBox3f bounds;
    std::size_t first = 0, last = 0;  ///< its points: [first, last)
  };
  std::vector<MapPoint> points;
  std::vector<Tile> tiles;
  MapCounts counts;
};

}  // namespace dvi
