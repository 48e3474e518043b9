#pragma once

#include <vector>

#include "dvi/sections/planned_section.h"

namespace dvi::sections {

/// Joins the removed objects of the target. Each frame of the whole drive has the labels of the section that fills it. An
/// object has one number in all sections: objects of neighboring sections are the same if their labels coincide in most frames
/// of the overlap that show both. Numbers are kept where they are unique. An object moves if it moves in any section.
objects::CameraObjects join_objects(const std::vector<PlannedSection>& sections, const Drive& target);

}  // namespace dvi::sections
