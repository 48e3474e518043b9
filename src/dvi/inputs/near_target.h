#pragma once

#include <optional>

#include "dvi/drive/drive.h"

namespace dvi::inputs {

/// The distance in meters between positions of two drives beyond which their cameras have no view of the same surface.
constexpr double kMaxSharedViewM = 150;

/// Returns the time from the first to the last given pose of a source drive that is within kMaxSharedViewM of a frame of the
/// target, or up to 70 m more, because the target's path is stored as cells. Returns none if no pose is. Both drives must have
/// given poses in one world. The computing time is linear in the number of poses.
std::optional<TimeSpan> time_near_target(const Drive& target, const Drive& source);

}  // namespace dvi::inputs
