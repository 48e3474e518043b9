#pragma once

#include <string>
#include <vector>

#include "dvi/diagnostics/flow_pairs.h"

namespace dvi::diagnostics {

/// What of the drive's camera (K, camera_from_lidar, clock) the pairs contradict, each with the remedy; empty where they bear
/// it out, or cannot tell.
std::vector<std::string> camera_doubts(const FlowPairs& pairs, const SE3& camera_from_lidar);

}  // namespace dvi::diagnostics
