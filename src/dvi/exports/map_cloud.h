#pragma once

#include <vector>

#include <Eigen/Core>

#include <opencv2/core/matx.hpp>

#include "dvi/core/files.h"

namespace dvi::exports {

/// A point of the static map as a result keeps it.
struct CloudPoint {
  Eigen::Vector3f position;       ///< meters, world axes
  cv::Vec3b color;                ///< BGR
  Eigen::Vector3f normal;         ///< of the surface; zeros where unknown
  float intensity = 0;            ///< as the LiDAR gave it
  float first_s = 0, last_s = 0;  ///< when it was measured, in seconds after the first scan

  /// Whether a frame saw it. Points that none did are gray.
  bool colored() const { return color != cv::Vec3b(128, 128, 128); }
};

/// The points of OUT/map/map.ply. InputError where the file is missing or not as dvi writes it. `most`: evenly thinned to so
/// many points; 0: all.
std::vector<CloudPoint> read_map_cloud(const fs::path& ply, std::size_t most = 0);

/// Every nth, so that at most `most` stay, in their order; 0: all.
std::vector<CloudPoint> thinned(const std::vector<CloudPoint>& cloud, std::size_t most);

}  // namespace dvi::exports
