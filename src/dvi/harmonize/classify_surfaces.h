#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/depth/target.h"
#include "dvi/ground/road_ground.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// The SurfaceClass of each pixel of a frame's hole and of 24 px round it; unknown elsewhere, and without ground. Pixels below
/// the horizon that are not copied and whose depth is unknown or unsure get the class of the pixels to either side.
cv::Mat1b classify_surfaces(const depth::Target& target, const sample::Candidates& candidates,
                            const ground::RoadGround& ground);

}  // namespace dvi::harmonize
