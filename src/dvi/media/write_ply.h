#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <opencv2/core/matx.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// An additional float per point, by the name that viewers show ("intensity", "t").
struct PlyScalar {
  std::string name;
  std::span<const float> values;
};

/// The content of a PLY, which is not copied. Each property has one entry per point.
struct PlyCloud {
  std::span<const Eigen::Vector3f> points;
  std::span<const cv::Vec3b> colors = {};  ///< BGR; empty: none
  std::vector<PlyScalar> scalars = {};
  std::string comment = {};  ///< one line for the header
  /// The origin of the points. If it is not zero, positions are written as doubles.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// Writes a binary little-endian PLY for CloudCompare and MeshLab beside its path and renames it. Throws InputError on a full
/// or read-only disk.
void write_ply(const fs::path& path, const PlyCloud& cloud);

}  // namespace dvi::media
