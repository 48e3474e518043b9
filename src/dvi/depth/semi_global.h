#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi::depth {

/// The costs of differences between the labels of neighbors.
struct StepCosts {
  float one_label;  ///< The cost of a difference of one label.
  float more;       ///< The cost of any larger difference.
};

/// Sums the costs of every label at every pixel along eight paths (semi-global matching: H. Hirschmueller, Stereo processing by
/// semiglobal matching and mutual information, PAMI 2008). `cost` is CV_32F with one channel per label; the result has the same
/// shape. Paths end at pixels where `member` is 0.
cv::Mat sum_path_costs(const cv::Mat& cost, const cv::Mat1b& member, const StepCosts& steps);

}  // namespace dvi::depth
