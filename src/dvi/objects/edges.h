#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/objects/other_times.h"

namespace dvi::objects {

/// Up to so many half pixels beyond its mask an edge of an object is looked for in views of so many: masks lack tires, rims and
/// what passes between two rays of 64 beams, half a degree; a view has about 80 degrees.
int edge_reach(const cv::Size& half_size);

/// A mask (half size) with what is missing of its objects' edges: what touches it and differs from what other times show there
/// and a pixel beside, by more than almost everything farther away from the mask does. Nothing thin that leads away from it, as
/// displaced edges of what stands. `image`: of the same view.
cv::Mat1b with_edges(const cv::Mat1b& mask, const Usual& usual, const Patch& image, int reach);

}  // namespace dvi::objects
