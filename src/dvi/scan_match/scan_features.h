#pragma once

#include <optional>

#include "dvi/drive/drive.h"
#include "dvi/scan_match/register_scan.h"

namespace dvi::scan_match {

/// The options for thinning and matching scans.
struct MatchOptions {
  std::optional<double> min_range_m = {};  ///< of scans; none: Drive::min_range_m()
  std::optional<double> max_range_m = {};  ///< none: Drive::max_range_m(); features use a slightly smaller range
  double spacing_m = 0.2;                  ///< edge of the cubes with one feature each in the local map
  double cell_m = 0.6;                     ///< edge of the cubes with one feature each in registration
  double voxel_m = 0.5;                    ///< edge of the small voxels of the local map; large ones are three times as wide
  double noise_m = 0.03;                   ///< standard deviation of returns across a flat surface
  double kernel_m = 0.1;                   ///< scale of the robust kernel: larger distances to a surface are outliers
};

/// The stored features of a scan.
struct ScanFeatures {
  Features dense, sparse;  ///< for the map and for registration
};

/// Adapts the options, which have lengths for streets, to the drive's sensor: its range unless the user sets one, and lengths.
/// A depth camera observes nearer, denser and smaller surfaces.
MatchOptions adapt_to_sensor(MatchOptions options, const Drive& drive);

/// Finds the beams of a scan of the drive; none for a depth image.
Rings find_scan_rings(const Drive& drive, const Scan& scan);

/// Returns the distance in meters up to which features are extracted.
double find_feature_range(const MatchOptions& options);

/// Extracts the features of a scan of the drive.
ScanFeatures extract_scan_features(const Drive& drive, const Scan& scan, const Rings& rings, const MatchOptions& options);

/// Makes an empty scene with the voxels of the options.
LocalMaps make_empty_scene(const MatchOptions& options);

/// Converts the options to those of register_scan().
RegisterOptions to_register_options(const MatchOptions& options);

}  // namespace dvi::scan_match
