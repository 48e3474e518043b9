#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "dvi/drive/scan.h"
#include "dvi/scan_match/rings.h"

namespace dvi::scan_match {

/// A point of a scan that constrains registration.
struct Feature {
  Eigen::Vector3f point;  ///< meters, LiDAR axes, as measured
  float time;             ///< seconds after the scan's stamp
};

/// The features of a scan.
struct Features {
  std::vector<Feature> planes;  ///< on smooth parts of a beam
  std::vector<Feature> edges;   ///< at corners, and at the centers of thin free-standing objects (poles, trunks)
};

/// The options of find_features().
struct FeatureOptions {
  double min_range_m = 2.5, max_range_m = 90;
  double spacing_m = 0.15;  ///< spacing of the plane features along a beam
};

/// Finds features by the curvature of each beam: the distance of a point from the means of the five neighbors before and after
/// it (Zhang and Singh, LOAM, 2014). Without rings, all points count as smooth.
Features find_features(const Scan& scan, const Rings& rings, const FeatureOptions& options);

/// Keeps the first feature in each cube of edge `cell_m`.
std::vector<Feature> thin_features(const std::vector<Feature>& features, double cell_m);

}  // namespace dvi::scan_match
