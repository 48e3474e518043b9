#pragma once

#include "dvi/objects/detect/description.h"

#include <opencv2/core/mat.hpp>

namespace dvi::objects {

/// The position of an image in a network's input. Along each axis, with pixel centers at whole numbers:
/// x_in_input + 0.5 = scale * (x_in_image + 0.5) + offset.
struct InputFit {
  cv::Size image, input;
  cv::Rect content;  ///< the part of the input that the image covers
  cv::Point2d scale, offset;

  /// Converts a position in the input, measured from its corner, to a position in the image.
  cv::Point2d to_image(cv::Point2d in_input) const {
    return {(in_input.x - offset.x) / scale.x, (in_input.y - offset.y) / scale.y};
  }
};

/// Fits an image of a size into the input.
InputFit fit_image(cv::Size image, const Description& description);

/// Converts an image to the network's input: 1 x 3 x height x width, float.
cv::Mat make_input_blob(const cv::Mat3b& image, const InputFit& fit, const Description& description);

/// Resamples a map, which covers the whole input at any resolution, to the pixels of a part of the image. Bilinear.
cv::Mat1f resample_to_image(const cv::Mat1f& map, const InputFit& fit, cv::Rect part);

}  // namespace dvi::objects
