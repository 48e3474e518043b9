#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

namespace dvi::objects {

/// One object that a network detects in one image.
struct Detection {
  int type = 0;         ///< index of its class
  float score = 1;      ///< 0..1; 1 if the network has no scores
  cv::Rect box;         ///< in the image
  cv::Mat1b mask;       ///< size of the box; 255 = object
  bool is_box = false;  ///< whether the network shows the box only, so that the mask is all of it
};
using Detections = std::vector<Detection>;

}  // namespace dvi::objects
