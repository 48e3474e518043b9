#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/image/color_range.h"
#include "dvi/sample/candidates.h"

namespace dvi::harmonize {

/// 1st to 99th percentile of what lies within 40 px of the hole (255), outside of it; all colors where nothing does.
ColorRange range_round(const cv::Mat3b& image, const cv::Mat1b& hole);

/// Keeps each copied pixel of `color`, which is of the size of the image, within `surroundings`, widened to what was copied
/// for it and its eight neighbors. `copies` as candidates.hole.pixels. Where sources disagree at the rim, the solution may
/// leave that range: nothing that any frame shows there is so dark or so bright.
void keep_within(const ColorRange& surroundings, const sample::Candidates& candidates, const std::vector<cv::Vec3f>& copies,
                 cv::Mat3f& color);

}  // namespace dvi::harmonize
