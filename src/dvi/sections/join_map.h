#pragma once

#include <functional>

#include "dvi/map/static_map.h"
#include "dvi/sections/planned_section.h"

namespace dvi::sections {

/// Joins the maps of the sections in the joint world, one after the other, so that only one of them is in memory beside the
/// joint map. Points of an overlap are taken from the section in whose part of the drive they were observed on average, removed
/// points, which have no time, from the section whose path is nearest. `load_map` returns the map of a section. The counts are
/// sums, in which the overlaps count twice.
map::StaticMap join_maps(const std::vector<PlannedSection>& sections, const inputs::Poses& poses,
                         const std::vector<Border>& borders,
                         const std::function<map::StaticMap(std::size_t section)>& load_map);

}  // namespace dvi::sections
