#pragma once

#include <memory>

#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// Refines the masks of posed views, which are generous outlines of objects, to silhouettes. Each view is compared with the
/// background model, at equal exposure. Pixels that differ and are connected to an outline are the object. Boundary pixels of
/// an outline that show the background are removed, and those with an unobserved background stay. All views belong to one
/// drive; `static_depth` is the result of render_static_depth(), `ground` the ground of the drive. Masks are per view, on
/// demand, and each is computed once. Method: docs/algorithms/motion_segmentation.md.
Lazy<cv::Mat1b> refine_silhouettes(const Views& views, const Lazy<cv::Mat1f>& static_depth,
                                   const std::shared_ptr<const ground::ScanGround>& ground);

}  // namespace dvi::objects
