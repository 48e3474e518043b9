#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/depth/target.h"
#include "dvi/ground/road_ground.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// Determines the SurfaceClass of each pixel of a frame's hole and of 24 px around it, from its height above the ground. It is
/// unknown elsewhere, for views without LiDAR, and if the drive has no ground. Pixels below the horizon that are not copied and
/// whose depth is unknown or uncertain get the class of the pixels at both sides.
cv::Mat1b classify_surfaces(const depth::Target& target, const sample::Candidates& candidates,
                            const ground::RoadGround& ground);

}  // namespace dvi::harmonize
