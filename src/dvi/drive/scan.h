#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/cache_budget.h"

namespace dvi {

/// The returns of one revolution of the LiDAR, as measured: not compensated for the motion during it.
struct Scan {
  std::vector<Eigen::Vector3f> points;  ///< meters, LiDAR axes
  std::vector<float> intensity;         ///< one a point
  std::vector<float> time;              ///< one a point: seconds after the scan's stamp (negative before)
  std::vector<std::uint16_t> ring;      ///< one a point, or empty where the file does not tell

  std::size_t size() const { return points.size(); }
  std::size_t bytes() const { return bytes_of(points) + bytes_of(intensity) + bytes_of(time) + bytes_of(ring); }
};

}  // namespace dvi
