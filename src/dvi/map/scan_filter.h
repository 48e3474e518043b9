#pragma once

#include <optional>
#include <vector>

#include "dvi/map/build_map.h"

namespace dvi::map {

/// The points of one scan after filtering by masks, labels, and options.
struct FilteredScan {
  struct Kept {
    Eigen::Vector3d position;  ///< meters, world axes
    float intensity;
  };
  std::vector<Kept> kept;
  std::vector<RemovedPoint> removed;
  std::optional<Eigen::Vector3f> sensor;  ///< position at the middle of the scan; nothing if there is no pose
  MapCounts counts;
};

/// Compensates scan `index` of a drive for its motion and filters it by the frame nearest in time (section 3.1 of the paper).
FilteredScan filter_scan(const MapInput& input, const MapOptions& options, std::size_t index);

}  // namespace dvi::map
