#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/interrupt.h"
#include "dvi/registration/key_scans.h"

namespace dvi::registration {

/// Parameters of the registration of key scans to the scans of placed drives.
struct ScanConstraintParams {
  double max_distance_m = 60;          ///< to scans that may show the same structures
  double scan_spacing_m = 2.5;         ///< between scans of one drive in a local map
  std::size_t max_scans = 12;          ///< of a local map
  double max_center_distance_m = 5;    ///< a local map is reused within this distance
  double min_static_share = 0.15;      ///< share of a scan's static features that lie on surfaces of the local map
  double min_relative_share = 0.3;     ///< of the same share for a scan of the local map's own drive; cars and leaves differ
  double max_relative_residual = 1.5;  ///< of the residual of that scan
  double max_correction_m = 0.5;       ///< from the pose that odometry predicts
  double max_correction_rad = 0.03;    ///< likewise
};
inline constexpr ScanConstraintParams kScanConstraint;

/// The pose of a key scan relative to a key scan of a drive that is placed already.
struct ScanConstraint {
  std::size_t drive = 0;  ///< index of the placed drive
  std::size_t a = 0;      ///< key scan of the placed drive
  std::size_t b = 0;      ///< key scan of the drive that is registered
  SE3 a_from_b;
  Matrix6d information = Matrix6d::Zero();  ///< as in scan_match::Registration
  double residual_m = 0;
};

/// The key scans of the drives that are placed, in one world.
using PlacedKeys = std::vector<const KeyScans*>;

/// A key scan with its pose.
struct PosedKey {
  std::size_t key = 0;
  SE3 world_from_lidar;
};

/// Registers the key scans of `keys` to the drives that are placed, in both directions from key scan `first`. Each scan starts
/// from where odometry predicts it after the scan before; a scan that overlaps too little gives no constraint. `tick` is called
/// once per key scan.
std::vector<ScanConstraint> find_scan_constraints(const PlacedKeys& placed, const KeyScans& keys, const PosedKey& first,
                                                  const Tick& tick);

}  // namespace dvi::registration
