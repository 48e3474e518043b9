#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace dvi::scan_match {

/// The cube of a grid that contains a point: 21 bits per axis.
using VoxelKey = std::uint64_t;

inline VoxelKey voxel_key(const Eigen::Vector3d& point, double edge_m) {
  constexpr std::int64_t kOffset = 1 << 20, kMask = (1 << 21) - 1;
  const auto axis = [&](double v) {
    return static_cast<std::uint64_t>((static_cast<std::int64_t>(std::floor(v / edge_m)) + kOffset) & kMask);
  };
  return axis(point.x()) << 42 | axis(point.y()) << 21 | axis(point.z());
}

struct VoxelHash {
  std::size_t operator()(VoxelKey key) const {
    key ^= key >> 32;
    key *= 0x9E3779B97F4A7C15ULL;
    return key ^ key >> 29;
  }
};

}  // namespace dvi::scan_match
