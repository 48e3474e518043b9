#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/odometry/odometry.h"

namespace dvi::inputs {

/// The distance in meters between parts of a drive whose relative pose is unknown. No vehicle moves so far between two poses.
inline constexpr double kSeparationM = 5000;

/// The scans [first, last) of a drive, without a gap in time.
struct Stretch {
  std::size_t first = 0, last = 0;
};

/// Splits the scans at gaps longer than a second and longer than three median steps, unless given poses cover both sides of the
/// gap. Returns one stretch if there is no such gap.
std::vector<Stretch> split_at_gaps(const Drive& drive, const Trajectory& given);

/// Estimates the odometry of a drive that may have gaps. Constant motion across a gap is only a guess, and a street may look
/// alike in several places, so odometry is estimated for each stretch alone. Stretches with given poses are aligned to these.
/// The others are registered to them, or to the longest stretch, as a source drive to its target (registration.h). A stretch
/// that cannot be registered is placed kSeparationM beside the others, so that the parts do not observe each other, and a
/// warning describes the gap.
odometry::Odometry estimate_odometry(const Drive& drive, const odometry::OdometryOptions& options, const Trajectory& given,
                                     Progress& progress);

/// Returns the sum of the distances between poses, without the distances between separated parts.
double path_length_m(const std::vector<StampedPose>& poses);

}  // namespace dvi::inputs
