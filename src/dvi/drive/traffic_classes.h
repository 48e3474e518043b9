#pragma once

#include <functional>
#include <set>
#include <string>

namespace dvi {

/// Returns the names of vehicles, people, and animals in COCO, Cityscapes, KITTI, and Mapillary, in lower case.
const std::set<std::string, std::less<>>& traffic_classes();

/// Returns whether one of the words of a class name is one of these: "other_vehicle" and "human.pedestrian.adult" are, "road"
/// and "3" are not.
bool is_traffic_class(const std::string& name);

}  // namespace dvi
