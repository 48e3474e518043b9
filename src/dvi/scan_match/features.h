#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "dvi/drive/scan.h"
#include "dvi/scan_match/rings.h"

namespace dvi::scan_match {

/// A point of a scan that the scene's shape can hold on to.
struct Feature {
  Eigen::Vector3f point;  ///< meters, LiDAR axes, as measured
  float time;             ///< seconds after the scan's stamp
};

struct Features {
  std::vector<Feature> planes;  ///< on smooth stretches of a beam
  std::vector<Feature> edges;   ///< on corners, and the middles of thin things that stand free (poles, trunks)
};

struct FeatureOptions {
  double min_range_m = 2.5, max_range_m = 90;
  double spacing_m = 0.15;  ///< between plane features of a beam
};

/// By how each beam bends, between the means of five neighbors before and after (Zhang and Singh, LOAM, 2014). Without rings
/// every point counts as smooth.
Features find_features(const Scan& scan, const Rings& rings, const FeatureOptions& options);

/// One feature a cube of edge `cell_m`, the first in order.
std::vector<Feature> thinned(const std::vector<Feature>& features, double cell_m);

}  // namespace dvi::scan_match
