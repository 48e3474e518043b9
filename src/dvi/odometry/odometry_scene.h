#pragma once

#include "dvi/odometry/odometry.h"
#include "dvi/odometry/register_scan.h"

namespace dvi::odometry {

/// What odometry keeps of a scan.
struct ScanFeatures {
  Features dense, sparse;  ///< for the map, and for registering
};

/// The range of the drive's sensor, where the user gives none, and lengths that suit it: the options hold those of streets.
/// What a depth camera sees is nearer and denser, its surfaces are smaller.
OdometryOptions for_sensor(OdometryOptions options, const Drive& drive);

/// The beams of a scan of the drive; none of a depth image.
Rings rings_of(const Drive& drive, const Scan& scan);

/// Distance in metres up to which features are taken from a scan.
double feature_range(const OdometryOptions& options);

/// Of a scan of the drive.
ScanFeatures scan_features(const Drive& drive, const Scan& scan, const Rings& rings, const OdometryOptions& options);

Surroundings empty_scene(const OdometryOptions& options);

RegisterOptions register_options(const OdometryOptions& options);

}  // namespace dvi::odometry
