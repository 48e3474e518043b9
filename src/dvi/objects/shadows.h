#pragma once

#include <memory>

#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// The masks of posed views, and beside each masked object the ground that its shadow darkens or that mirrors it: what differs
/// there from the same ground at other times, in common light, and hangs together with the mask. On demand, as `views`;
/// each is found once, and its outline kept. Views of one drive; `ground` is its ground, in the world of the views.
Lazy<cv::Mat1b> with_shadows(const Views& views, const std::shared_ptr<const ground::ScanGround>& ground);

}  // namespace dvi::objects
