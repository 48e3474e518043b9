#pragma once

#include <cstdint>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/sections/planned_section.h"

namespace dvi::sections {

/// Joins the poses of all sections in the world of the first one, with one entry per recording of the whole drive. Each section
/// is aligned to the one before it by their poses in the overlap (rotation and translation). Near a border, poses change from
/// one section to the other gradually, so that the path has no step. Warns if sections disagree about an overlap, or if the
/// path returns to a place of an earlier section: loops are closed inside of sections only. Throws InputError if two sections
/// have no common pose.
inputs::Poses join_poses(const std::vector<PlannedSection>& sections, const inputs::Recordings& drives,
                         const std::vector<Border>& borders, Progress& progress);

/// Returns the motion from the world of a section to the joint world at the time of a pose of its recording `local`; none
/// without a pose. `joint` is the joint trajectory of the same recording.
std::optional<SE3> joint_from_section(const Trajectory& joint, const PlannedSection& section, std::size_t local,
                                      std::int64_t time_ns);

}  // namespace dvi::sections
