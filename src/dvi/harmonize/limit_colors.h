#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/color_range.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// Computes the range from the 1st to the 99th percentile of the colors within 40 px of the hole (255), per channel. Without
/// such pixels, the range has all colors.
ColorRange find_range_around(const cv::Mat3b& image, const cv::Mat1b& hole);

/// Limits each copied pixel of `color`, an image, to `surroundings`, extended by the copies of the pixel and of its eight
/// neighbors. `copies` has one color per hole pixel. Where sources contradict the boundary, the solution of eq. 5 may exceed
/// that range, although no frame shows such colors there.
void limit_copies(const ColorRange& surroundings, const sample::Candidates& candidates, const std::vector<cv::Vec3f>& copies,
                  cv::Mat3f& color);

}  // namespace dvi::harmonize
