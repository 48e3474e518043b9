#pragma once

#include <cstddef>
#include <vector>

#include "dvi/sections/planned_section.h"

namespace dvi::sections {

/// The section that a view of the whole drive is taken from, and the index of the view there.
struct ViewSource {
  std::size_t section = 0, view = 0;
};

/// The sections, and all views of the whole drive. Holds references only.
struct JointViews {
  const std::vector<PlannedSection>& sections;
  const Views& views;
  const inputs::Recordings& drives;
  const std::vector<Border>& borders;
};

/// Returns the source of each view of the whole drive: for the cameras of the target, the section that fills the frames of its
/// time; for source drives, and if that section has no pose for the view, the section in which the view is farthest from both
/// ends of its sequence. Throws InputError if no section has the view.
std::vector<ViewSource> find_view_sources(const JointViews& joint);

/// Views with the recordings that their sequences refer to. Holds references only.
struct RecordedViews {
  const Views& views;
  const inputs::Recordings& drives;
};

/// Returns the index in `joint` of each view of a section. Throws InputError if a view is missing there.
std::vector<std::size_t> number_views(const RecordedViews& section, const RecordedViews& joint);

/// Joins the gains. Gains are relative to the mean of a section; the factor between neighbors is the mean ratio of the gains of
/// the views that both have.
exposure::Gains join_gains(const JointViews& joint);

/// Joins the refined poses: each view keeps its position relative to the LiDAR in the section that it is taken from.
align::Cameras join_cameras(const JointViews& joint, const inputs::Poses& poses);

}  // namespace dvi::sections
