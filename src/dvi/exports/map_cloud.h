#pragma once

#include <vector>

#include <Eigen/Core>

#include <opencv2/core/matx.hpp>

#include "dvi/core/files.h"

namespace dvi::exports {

/// A point of a result's static map.
struct CloudPoint {
  Eigen::Vector3f position;       ///< meters, world axes
  cv::Vec3b color;                ///< BGR
  Eigen::Vector3f normal;         ///< of the surface; zero if unknown
  float intensity = 0;            ///< as measured by the LiDAR
  float first_s = 0, last_s = 0;  ///< first and last time of measurement, in seconds after the first scan

  /// Returns whether a frame observed the point. Unobserved points are gray.
  bool colored() const { return color != cv::Vec3b(128, 128, 128); }
};

/// Reads the points of OUT/map/map.ply, thinned evenly to `most` points (0: all). Throws InputError if the file is missing or
/// not as written by dvi.
std::vector<CloudPoint> read_map_cloud(const fs::path& ply, std::size_t most = 0);

/// Keeps every n-th point in order, so that at most `most` points are left; 0: all.
std::vector<CloudPoint> thin_cloud(const std::vector<CloudPoint>& cloud, std::size_t most);

}  // namespace dvi::exports
