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
  /// If its file also has points that are not returns: the number of all of them, and the index of each return among them.
  std::size_t file_points = 0;
  std::vector<std::uint32_t> file_index = {};

  std::size_t size() const { return points.size(); }
  /// Returns the number of points in the scan's file.
  std::size_t size_in_file() const { return file_index.empty() ? size() : file_points; }
  /// Returns the index of a return among the points in the scan's file.
  std::size_t index_in_file(std::size_t point) const { return file_index.empty() ? point : file_index[point]; }
  std::size_t bytes() const {
    return bytes_of(points) + bytes_of(intensity) + bytes_of(time) + bytes_of(ring) + bytes_of(file_index);
  }
};

}  // namespace dvi
