#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/files.h"
#include "dvi/drive/scan.h"

namespace dvi::io {

/// From where points are counted: from the origin of the file's coordinates, or from its first point.
enum class CountFrom { origin, first_point };

/// The points of one file as they stand there.
struct PointCloud {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of `points`: not zero in maps only
  std::vector<Eigen::Vector3f> points;               ///< metres from `origin`
  std::vector<float> intensity;                      ///< one a point; 0 where the file tells none
  std::vector<float> t;                              ///< one a point: seconds after the scan's start; or empty
  std::vector<std::uint16_t> ring;                   ///< one a point; or empty

  /// Adds a point by its position in the file.
  void add(const Eigen::Vector3d& position, float intensity_there, CountFrom from = CountFrom::first_point) {
    if (points.empty() && from == CountFrom::first_point) origin = position;
    points.emplace_back((position - origin).cast<float>());
    intensity.push_back(intensity_there);
  }
};

/// Reads .bin (float32 x y z intensity), .ply or .pcd (ascii or binary) by its ending. InputError where the file cannot be
/// parsed, is cut short, holds no points or points that are not finite.
PointCloud read_point_cloud(const fs::path& path);

/// Reads a map: .ply, .pcd or .las. Its first point is the origin of the others, so that coordinates of a map projection keep
/// their millimetres. InputError as above.
PointCloud read_map_cloud(const fs::path& path);

/// The bytes of a .bin of a scan's points and intensities.
std::string bin_bytes(const Scan& scan);

/// What the size of such a file tells without reading it. InputError where it holds no points, or no whole number of them.
void check_size(const fs::path& path);

}  // namespace dvi::io
