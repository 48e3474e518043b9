#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// The view into which outlines are drawn.
struct OutlineView {
  const Camera& camera;
  SE3 world_from_lidar;
  SE3 camera_from_lidar;
  double footprint_m = 0;  ///< width of the ground around an object that is masked with it: wheels, and the darkest shadow
};

/// Returns the class of an object for Label::type by its size in meters, seen from above: a vehicle is longer than a person.
std::string type_by_size(const Eigen::Vector2d& size_m);

/// Draws a tracked object into an image taken at `time_ns`: the returns of the nearest scan, moved along the track, and the
/// ground below and around them. Returns nothing if the track has no returns near that time or they lie outside the image.
std::optional<Label> draw_outline(const Track& track, std::int64_t time_ns, const OutlineView& view);

/// The evidence of scans for the position of a tracked object. none: no scan within a quarter of a second. weak: the returns
/// are too few and too far apart for its position and shape.
enum class ScanEvidence : std::uint8_t { none, weak, strong };

/// Rates the evidence for a track at a time.
ScanEvidence rate_scan_evidence(const Track& track, std::int64_t time_ns);

}  // namespace dvi::objects
