#pragma once

#include <cstddef>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/odometry/odometry.h"

namespace dvi::inputs {

/// No vehicle moves so far from one pose to the next: meters between parts of a drive whose relative position is unknown.
inline constexpr double kApartM = 5000;

/// Scans [first, last) of a drive without a gap in time.
struct Stretch {
  std::size_t first = 0, last = 0;
};

/// Splits the scans where no scan was taken for more than a second and three usual steps, unless given poses cover both sides
/// of the gap. One stretch where there is no such gap.
std::vector<Stretch> split_at_gaps(const Drive& drive, const Trajectory& given);

/// Odometry of a drive that may have gaps: across a gap, motion that goes on as before is only a guess, and a street looks
/// alike in several places. Each stretch has odometry of its own. Stretches with given poses are placed by these, the others
/// are registered to them, or to the longest, as a source drive is to its target (registration.h). What cannot be registered is
/// put kApartM beside the rest, so that no part of the drive observes what is on the other side, and a warning names the gap.
odometry::Odometry odometry_of_stretches(const Drive& drive, const odometry::OdometryOptions& options, const Trajectory& given,
                                         Progress& progress);

/// The sum of the steps between poses, without those from one part of a drive to another that lies apart.
double path_length_m(const std::vector<StampedPose>& poses);

}  // namespace dvi::inputs
