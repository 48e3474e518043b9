#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/cache_budget.h"

namespace dvi {

/// The returns of one revolution of the LiDAR as measured, not compensated for motion.
struct Scan {
  std::vector<Eigen::Vector3f> points;  ///< meters, LiDAR axes
  std::vector<float> intensity;         ///< one per point
  std::vector<float> time;              ///< one per point: seconds after the scan's stamp (negative before it)
  std::vector<std::uint16_t> ring;      ///< one per point, or empty if unknown

  std::size_t size() const { return points.size(); }
  std::size_t bytes() const { return bytes_of(points) + bytes_of(intensity) + bytes_of(time) + bytes_of(ring); }
};

}  // namespace dvi
