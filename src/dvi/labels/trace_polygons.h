#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/outline.h"

namespace dvi::labels {

/// Returns polygons whose pixels, by to_outline(), are those of a mask that are not 0: one per connected part, the largest
/// first. A hole is joined to the boundary by a cut of no width, so that tools without holes show it. Corners of the boundary
/// are left out as long as the overlap with the mask (intersection over union) stays at least `min_overlap`.
std::vector<Polygon> trace_polygons(const cv::Mat1b& mask, double min_overlap = 0.995);

}  // namespace dvi::labels
