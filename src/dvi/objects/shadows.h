#pragma once

#include <memory>

#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// Adds shadows and reflections to the masks of posed views: ground beside a masked object that differs from the same ground at
/// other times, at equal exposure, and is connected to the mask. Upright surfaces, which the returns of the views show, hide
/// the ground. Masks are per view, on demand, and each is computed once. All views belong to one drive; `ground` is its ground
/// in the world of the views. Method: docs/algorithms/objects.md.
Lazy<cv::Mat1b> add_shadows(const Views& views, const std::shared_ptr<const ground::ScanGround>& ground);

}  // namespace dvi::objects
