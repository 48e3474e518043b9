#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <opencv2/core/matx.hpp>

#include "dvi/core/files.h"

namespace dvi::media {

/// One more float a point, by the name viewers show ("intensity", "t").
struct PlyScalar {
  std::string name;
  std::span<const float> values;
};

/// What a PLY holds; nothing is copied. Whatever is given besides points has one entry a point.
struct PlyCloud {
  std::span<const Eigen::Vector3f> points;
  std::span<const cv::Vec3b> colors = {};  ///< BGR; empty: none
  std::vector<PlyScalar> scalars = {};
  std::string comment = {};  ///< one line for the header
  /// Of the points; where it is not zero, positions are written as doubles.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// Binary little-endian PLY as CloudCompare and MeshLab open it, written beside its place and renamed. InputError on a full
/// or read-only disk.
void write_ply(const fs::path& path, const PlyCloud& cloud);

}  // namespace dvi::media
