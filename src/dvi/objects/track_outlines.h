#pragma once

#include <cstdint>
#include <optional>

#include "dvi/objects/tracks.h"

namespace dvi::objects {

/// A tracked object as the image taken at `time_ns` shows it: the returns of the scan nearest to it, moved along the track,
/// down to the ground and to `footprint_m` of it all round: its wheels, and the darkest of its shadow. None where the track has
/// no returns near that time or they lie outside the image.
std::optional<Label> outline(const Track& track, std::int64_t time_ns, const Camera& camera, const SE3& world_from_lidar,
                             const SE3& camera_from_lidar, double footprint_m);

/// How well scans show where a tracked object is at a time: not within a quarter of a second; by returns too few and too far
/// apart for its place and shape; well.
enum class ScanEvidence : std::uint8_t { no, poorly, well };
ScanEvidence shown_by_scans(const Track& track, std::int64_t time_ns);

}  // namespace dvi::objects
