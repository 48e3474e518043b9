#pragma once

#include <optional>

#include "dvi/drive/drive.h"
#include "dvi/scan_match/register_scan.h"

namespace dvi::scan_match {

/// How scans are thinned and matched.
struct MatchOptions {
  std::optional<double> min_range_m = {};  ///< of the scan; none: Drive::least_range_m()
  std::optional<double> max_range_m = {};  ///< none: Drive::most_range_m(); features come from somewhat less than both
  double spacing_m = 0.2;                  ///< edge of the cubes that give one feature each to the local map
  double cell_m = 0.6;                     ///< edge of the cubes that give one feature each to registration
  double voxel_m = 0.5;                    ///< edge of the small voxels of the local map; large ones are three times as wide
  double noise_m = 0.03;                   ///< standard deviation of returns across a flat surface
  double kernel_m = 0.1;                   ///< scale of the robust kernel: larger distances to a surface are outliers
};

/// What is kept of a scan.
struct ScanFeatures {
  Features dense, sparse;  ///< for the map, and for registering
};

/// The range of the drive's sensor, where the user gives none, and lengths that suit it: the options hold those of streets.
/// What a depth camera sees is nearer and denser, its surfaces are smaller.
MatchOptions for_sensor(MatchOptions options, const Drive& drive);

/// The beams of a scan of the drive; none of a depth image.
Rings rings_of(const Drive& drive, const Scan& scan);

/// Distance in meters up to which features are taken from a scan.
double feature_range(const MatchOptions& options);

/// Of a scan of the drive.
ScanFeatures scan_features(const Drive& drive, const Scan& scan, const Rings& rings, const MatchOptions& options);

LocalMaps empty_scene(const MatchOptions& options);

RegisterOptions register_options(const MatchOptions& options);

}  // namespace dvi::scan_match
