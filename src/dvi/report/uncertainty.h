#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi::report {

/// The expected errors of a filled frame according to its confidence.
struct Uncertainty {
  double within = 0;    ///< mean confidence of the hole: the share of its pixels expected within 10 gray levels of the truth
  double pixels = 0;    ///< number of pixels expected to have larger errors
  cv::Rect worst;       ///< the part of the image with most of these; empty if there is no hole
  double in_worst = 0;  ///< number of these in `worst`
};

/// Estimates the uncertainty from `kind` and `confidence` as in harmonize::FilledFrame.
Uncertainty estimate_uncertainty(const cv::Mat1b& kind, const cv::Mat1b& confidence);

}  // namespace dvi::report
