#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi::harmonize {

/// Adapts the fill of a hole that another program made to the frame around the hole, and returns the frame with the adapted
/// fill. The fill gets a correction that follows the difference of frame and fill at the pixels around the hole (4-neighbors)
/// and is as smooth as possible inside (its Laplacian is zero): colors agree at the boundary, and the gradients of the fill are
/// kept (P. Perez et al., Poisson image editing, SIGGRAPH 2003). Differences far from the median of a connected part of the
/// hole have little weight, because frame and fill show different objects there. A part without known neighbors gets no
/// correction. Outside the hole (0 in `hole`), the result is the frame. All images have the same size.
cv::Mat3b adapt_fill(const cv::Mat3b& frame, const cv::Mat3b& fill, const cv::Mat1b& hole);

}  // namespace dvi::harmonize
