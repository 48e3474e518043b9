#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "dvi/core/files.h"
#include "dvi/drive/scan.h"
#include "dvi/media/bin_layout.h"

namespace dvi::media {

/// From where points are counted: from the origin of the file's coordinates, or from its first point.
enum class CountFrom { origin, first_point };

/// The points of one file as they stand there.
struct PointCloud {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of `points`: not zero in maps only
  std::vector<Eigen::Vector3f> points;               ///< meters from `origin`
  std::vector<float> intensity;                      ///< one a point; 0 where the file tells none
  std::vector<double> t;                             ///< one a point: times in the unit of the file; or empty
  std::vector<std::uint16_t> ring;                   ///< one a point; or empty

  /// Adds a point by its position in the file.
  void add(const Eigen::Vector3d& position, float intensity_there, CountFrom from = CountFrom::first_point) {
    if (points.empty() && from == CountFrom::first_point) origin = position;
    points.emplace_back((position - origin).cast<float>());
    intensity.push_back(intensity_there);
  }
};

/// Whether a point of a scan was measured: organized clouds have points that are not finite, or at the origin, where a ray did
/// not return.
inline bool is_return(const Eigen::Vector3f& point) { return point.allFinite() && !point.isZero(); }

/// Reads .bin (by its layout), .ply or .pcd (ascii or binary) by its ending, without points that are no returns. InputError
/// where the file cannot be parsed, is truncated or holds no returns.
PointCloud read_point_cloud(const fs::path& path, const BinLayout& layout = {});

/// Reads a map: .ply, .pcd or .las, without points that are not finite. Its first point is the origin of the others, so that
/// coordinates of a map projection keep their millimeters. InputError as above.
PointCloud read_map_cloud(const fs::path& path);

/// The bytes of a .bin of a scan's points and intensities.
std::string bin_bytes(const Scan& scan);

/// What the size of such a file tells without reading it. InputError where it holds no points, or no whole number of them:
/// those of a .bin have `point_bytes`.
void check_size(const fs::path& path, std::size_t point_bytes);

}  // namespace dvi::media
