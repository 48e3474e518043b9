#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "dvi/core/lazy.h"
#include "dvi/drive/drive.h"
#include "dvi/scan_match/scan_features.h"

namespace dvi::registration {

/// What stands still, as one scan or several saw it: in LiDAR axes at the middle of the scan, the motion during it taken out.
struct StillScan {
  scan_match::Features dense, sparse;       ///< for the map, and for registering
  std::vector<scan_match::Feature> points;  ///< all returns, thinned: also what is neither smooth nor an edge, such as leaves

  std::size_t bytes() const {
    return sizeof(scan_match::Feature) *
           (dense.planes.size() + dense.edges.size() + sparse.planes.size() + sparse.edges.size() + points.size());
  }
};

/// The scans of a drive by which it is compared with others, half a meter of way apart or more. Copies share what was read.
class KeyScans {
 public:
  /// Where a scan was, and how it moved.
  struct Key {
    std::size_t scan = 0;  ///< of the drive
    SE3 world_from_lidar;
    Vector6d twist = Vector6d::Zero();  ///< per second, LiDAR axes
    double way_m = 0;                   ///< since the first
  };

  /// Features in labeled boxes and in the drive's mask files are left out. `drive` must outlive this.
  KeyScans(const Drive& drive, const scan_match::MatchOptions& options, const Trajectory& world_from_lidar);

  /// The same scans in another world.
  KeyScans in(const SE3& other_from_world) const;

  std::size_t size() const { return keys_.size(); }
  bool empty() const { return keys_.empty(); }
  const Key& operator[](std::size_t i) const { return keys_[i]; }
  std::shared_ptr<const StillScan> scan(std::size_t i) const { return scans_[i]; }
  const Drive& drive() const { return *drive_; }
  const Trajectory& world_from_lidar() const { return world_from_lidar_; }
  const scan_match::MatchOptions& options() const { return options_; }

 private:
  const Drive* drive_;
  scan_match::MatchOptions options_;
  Trajectory world_from_lidar_;
  std::vector<Key> keys_;
  Lazy<StillScan> scans_;
};

/// What the key scans up to `way_m` before and after one saw together, in its axes, thinned anew.
StillScan submap(const KeyScans& keys, std::size_t i, double way_m);

}  // namespace dvi::registration
