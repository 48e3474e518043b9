#pragma once

#include <opencv2/core/mat.hpp>

#include "dvi/synthesize/exemplars.h"

namespace dvi::synthesize {

/// Adapts the colors of the pixels of `inner` to those around them, without changing the gradients between them (eq. 5 of the
/// paper). Far from the boundary, colors remain as they are.
void adapt_to_boundary(cv::Mat3f& color, const cv::Mat1b& inner, const SurfaceGuide& guide);

}  // namespace dvi::synthesize
