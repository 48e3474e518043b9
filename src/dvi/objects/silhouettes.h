#pragma once

#include <memory>

#include "dvi/drive/view.h"
#include "dvi/ground/scan_ground.h"

namespace dvi::objects {

/// Where the objects end that the masks of posed views outline, generously, by their returns: each view is compared with what
/// others show of its background, in common light. What differs and hangs together with an outline is the object; the rim of an
/// outline that looks like its background leaves, and what nobody else saw stays as it is. Views of one drive; `standing` is
/// their static_depth(), `ground` the drive's ground. On demand, as `views`; each is found once.
Lazy<cv::Mat1b> silhouettes(const Views& views, const Lazy<cv::Mat1f>& standing,
                            const std::shared_ptr<const ground::ScanGround>& ground);

}  // namespace dvi::objects
