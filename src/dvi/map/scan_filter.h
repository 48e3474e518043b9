#pragma once

#include <optional>
#include <vector>

#include "dvi/map/build_map.h"

namespace dvi::map {

/// What masks, labels and options leave of one scan.
struct FilteredScan {
  struct Kept {
    Eigen::Vector3d position;  ///< meters, world axes
    float intensity;
  };
  std::vector<Kept> kept;
  std::vector<RemovedPoint> removed;
  std::optional<Eigen::Vector3f> sensor;  ///< where it was in the middle of the scan; none where the poses do not say
  MapCounts counts;
};

/// Scan `index` of a drive, compensated for its motion and judged by the frame nearest in time (section 3.1 of the paper).
FilteredScan filter_scan(const MapInput& input, const MapOptions& options, std::size_t index);

}  // namespace dvi::map
