#pragma once

#include <optional>

#include "dvi/drive/drive.h"

namespace dvi::inputs {

/// Meters between positions of two drives beyond which no camera of one sees what the other's target frames show.
constexpr double kFarApart = 150;

/// The time from a source drive's first given pose within kFarApart of a target frame's to its last one; up to 70 m more, since
/// the target's path is kept as cells. None where it comes nowhere near. Both drives must have given poses in one world. Time
/// grows with the sum of their poses.
std::optional<TimeSpan> time_near_target(const Drive& target, const Drive& source);

}  // namespace dvi::inputs
