#pragma once

#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::diagnostics {

/// Frames of a depth camera during which it turns so fast that their images are blurred, and that the rows of the image, if
/// they are exposed one after the other (rolling shutter), are bent against each other by more than dvi corrects; empty where
/// there are none, and for a LiDAR drive. In words, with the frames and the largest bend.
std::vector<std::string> fast_motion(const Drive& drive, const Trajectory& world_from_lidar);

}  // namespace dvi::diagnostics
