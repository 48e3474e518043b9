#pragma once

#include "dvi/map/odometry.h"
#include "dvi/map/register_scan.h"

namespace dvi {

/// What odometry keeps of a scan.
struct ScanFeatures {
  Features dense, sparse;  ///< for the map, and for registering
};

ScanFeatures scan_features(const Scan& scan, const Rings& rings, const OdometryOptions& options);

Surroundings empty_scene(const OdometryOptions& options);

RegisterOptions register_options(const OdometryOptions& options);

}  // namespace dvi
