#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/drive/drive.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::registration {

/// Parameters of key scans.
struct KeyScanParams {
  double min_step_m = 0.5;        ///< distance from one key scan to the next
  double point_spacing_m = 0.15;  ///< edge of the cubes of which each keeps one point
  double box_margin_m = 0.2;      ///< added to labeled boxes, because objects move while they are scanned
};
inline constexpr KeyScanParams kKeyScan;

/// The static part of one scan or several: in LiDAR axes at the middle of the scan, with the motion during the scan removed.
struct StaticScan {
  scan_match::Features dense;               ///< features for the map
  scan_match::Features sparse;              ///< features for registration
  std::vector<scan_match::Feature> points;  ///< all returns, thinned; includes rough surfaces such as leaves

  std::size_t bytes() const {
    return sizeof(scan_match::Feature) *
           (dense.planes.size() + dense.edges.size() + sparse.planes.size() + sparse.edges.size() + points.size());
  }
};

/// The scans by which a drive is compared with other drives, at least half a meter apart. Scans are read on demand; copies
/// share the scans read.
class KeyScans {
 public:
  /// The pose and motion of a key scan.
  struct Key {
    std::size_t scan = 0;  ///< index in the drive
    SE3 world_from_lidar;
    Vector6d twist = Vector6d::Zero();  ///< per second, LiDAR axes
    double path_length_m = 0;           ///< from the first key scan
  };

  /// Leaves out returns in labeled boxes and in the drive's mask files. `drive` must outlive this object.
  KeyScans(const Drive& drive, const scan_match::MatchOptions& options, const Trajectory& world_from_lidar);

  /// Returns the same scans in another world.
  KeyScans transform(const SE3& other_from_world) const;

  std::size_t size() const { return keys_.size(); }
  bool empty() const { return keys_.empty(); }
  const Key& operator[](std::size_t i) const { return keys_[i]; }
  std::shared_ptr<const StaticScan> scan(std::size_t i) const { return scans_[i]; }
  const Drive& drive() const { return *drive_; }
  const Trajectory& world_from_lidar() const { return world_from_lidar_; }
  const scan_match::MatchOptions& options() const { return options_; }

 private:
  const Drive* drive_;
  scan_match::MatchOptions options_;
  Trajectory world_from_lidar_;
  std::vector<Key> keys_;
  Lazy<StaticScan> scans_;
};

/// Merges the key scans up to `max_path_m` of path before and after key scan `i`, in the axes of key scan `i`, and thins them.
StaticScan make_submap(const KeyScans& keys, std::size_t i, double max_path_m);

}  // namespace dvi::registration
