#pragma once

#include "dvi/odometry/odometry.h"
#include "dvi/odometry/register_scan.h"

namespace dvi::odometry {

/// What odometry keeps of a scan.
struct ScanFeatures {
  Features dense, sparse;  ///< for the map, and for registering
};

/// Distance in metres up to which features are taken from a scan.
double feature_range(const OdometryOptions& options);

/// Of a scan of the drive.
ScanFeatures scan_features(const Drive& drive, const Scan& scan, const Rings& rings, const OdometryOptions& options);

Surroundings empty_scene(const OdometryOptions& options);

RegisterOptions register_options(const OdometryOptions& options);

}  // namespace dvi::odometry
