#pragma once

#include "dvi/objects/detect/description.h"

#include <opencv2/core/mat.hpp>

namespace dvi::objects {

/// Where an image lies in a network's input. Along each axis, with pixel centers at whole numbers:
/// x_in_input + 0.5 = scale * (x_in_image + 0.5) + offset.
struct InputFit {
  cv::Size image, input;
  cv::Rect content;  ///< of the input: where the image is
  cv::Point2d scale, offset;

  cv::Point2d in_image(cv::Point2d in_input) const {
    return {(in_input.x - offset.x) / scale.x, (in_input.y - offset.y) / scale.y};
  }
};

/// How an image of that size is fitted into the input.
InputFit fit_image(cv::Size image, const Description& description);

/// The image as the network's input: 1 x 3 x height x width, float.
cv::Mat input_blob(const cv::Mat3b& image, const InputFit& fit, const Description& description);

/// What the pixels of a part of the image see of a map that covers the whole input, at any resolution: bilinear.
cv::Mat1f map_in_image(const cv::Mat1f& map, const InputFit& fit, cv::Rect part);

}  // namespace dvi::objects
