#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/files.h"
#include "dvi/drive/scan.h"
#include "dvi/media/bin_layout.h"

namespace dvi::media {

/// The origin of points: that of the file's coordinates, or the first point.
enum class CountFrom { origin, first_point };

/// The points of one file.
struct PointCloud {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of `points`; zero except for maps
  std::vector<Eigen::Vector3f> points;               ///< meters from `origin`
  std::vector<float> intensity;                      ///< one per point; 0 if the file has none
  std::vector<double> t;                             ///< one per point, in the unit of the file; or empty
  std::vector<std::uint16_t> ring;                   ///< one per point; or empty
  std::size_t file_points = 0;                       ///< points in the file, with those that are left out
  std::vector<std::uint32_t> file_index{};           ///< one per point: its index in the file; empty if none is left out

  /// Adds a point by its position in the file.
  void add(const Eigen::Vector3d& position, float intensity_there, CountFrom from = CountFrom::first_point) {
    if (points.empty() && from == CountFrom::first_point) origin = position;
    points.emplace_back((position - origin).cast<float>());
    intensity.push_back(intensity_there);
  }
};

/// Returns whether a point of a scan was measured. Organized clouds have points that are not finite or at the origin for rays
/// without a return.
inline bool is_return(const Eigen::Vector3f& point) { return point.allFinite() && !point.isZero(); }

/// Reads .bin (by its layout), .ply or .pcd (ascii or binary) by its ending, without points that are not returns. Throws
/// InputError if the file cannot be parsed, is truncated or holds no returns.
PointCloud read_point_cloud(const fs::path& path, const BinLayout& layout = {});

/// Reads a map from .ply, .pcd or .las, without points that are not finite. The first point becomes the origin of the others,
/// so that coordinates of a map projection keep their precision. Throws the same errors.
PointCloud read_map_cloud(const fs::path& path);

/// Returns the bytes of a .bin file with a scan's points and intensities.
std::string to_bin_bytes(const Scan& scan);

/// Checks the size of a file without reading it. Throws InputError if it holds no points or not a whole number of them; those
/// of a .bin have `point_bytes` bytes.
void check_size(const fs::path& path, std::size_t point_bytes);

}  // namespace dvi::media
