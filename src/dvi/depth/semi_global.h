#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi::depth {

/// Semi-global matching (Hirschmueller, 2008): the costs of every label at every pixel, summed along eight paths on which a
/// step of one label between neighbors costs `small_step`, any larger one `large_step`. `cost`: CV_32F with as many channels
/// as there are labels. Paths begin anew where `member` is 0. Of the shape of `cost`.
cv::Mat semi_global(const cv::Mat& cost, const cv::Mat1b& member, float small_step, float large_step);

}  // namespace dvi::depth
