#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/core/lazy.h"

namespace dvi::objects {

/// Returns the axis-aligned rectangles that a connected part of a mask (255) consists of, as bounding boxes draw them; nothing
/// if it has another shape. Where rectangles overlap, those are chosen that cover the part with fewest.
std::vector<cv::Rect> split_into_boxes(const cv::Mat1b& part);

/// The margin of an object's silhouette, relative to the image's width: blur of its edge, and errors of the extrinsics.
inline constexpr double kSilhouetteMarginShare = 0.0025;

/// The pixels by which objects in bounding boxes are separated from their surroundings: 255 where a scan has a
/// return of the respective kind.
struct BoxSeeds {
  cv::Mat1b object, background;
  cv::Mat1f margin_px;  ///< at returns of objects: distance beyond which the object does not extend, as far as scans show it
  cv::Mat1b ground;     ///< on the ground below and beside objects, which their shadows may cover
};

/// A connected part of a mask that consists of bounding boxes.
struct BoxPart {
  cv::Rect area;                ///< in the image: the part and its surroundings
  cv::Mat1b mask;               ///< of the area: 255 in the part
  std::vector<cv::Rect> boxes;  ///< in the area
};

/// Returns the parts of a mask that consist of bounding boxes.
std::vector<BoxPart> find_box_parts(const cv::Mat1b& mask);

/// Returns the pixels of a part that show the background: 255, in the area of the part. Objects are separated from it by
/// GrabCut (Rother et al., 2004), which starts from the seeds, those of the whole image. Boxes without seeds of objects, and
/// those whose object does not reach across them, are objects as a whole.
cv::Mat1b find_background(const BoxPart& part, const cv::Mat3b& image, const BoxSeeds& seeds);

/// Returns the pixels that nearly all masks of a camera's frames cover (255): those of a banner or the ego vehicle, which are
/// fixed in the image, or of an object that keeps its place there. Nothing shows that a bounding box covers background there.
/// Looks at up to 100 masks. Returns no pixels of fewer than five masks.
cv::Mat1b find_fixed_pixels(const Lazy<cv::Mat1b>& masks);

}  // namespace dvi::objects
