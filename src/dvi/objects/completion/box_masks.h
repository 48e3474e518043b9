#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::objects {

/// Returns the axis-aligned rectangles that a connected part of a mask (255) consists of, as bounding boxes draw them; nothing
/// if it has another shape. Where rectangles overlap, those are chosen that cover the part with fewest.
std::vector<cv::Rect> split_into_boxes(const cv::Mat1b& part);

/// The pixels by which objects in bounding boxes are separated from what is beside and behind them: 255 where a scan has a
/// return of the respective kind.
struct BoxSeeds {
  cv::Mat1b object, background;
  cv::Mat1b ground;  ///< on the ground below and beside objects, which their shadows may cover
};

/// Returns the parts of a mask that consist of bounding boxes but show the background (255). Objects are separated from it by
/// GrabCut (Rother et al., 2004), which starts from the seeds. Boxes without seeds of objects remain as they are.
cv::Mat1b find_background_in_boxes(const cv::Mat3b& image, const cv::Mat1b& mask, const BoxSeeds& seeds);

}  // namespace dvi::objects
