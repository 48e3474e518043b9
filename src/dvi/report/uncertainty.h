#pragma once

#include <opencv2/core/mat.hpp>

namespace dvi::report {

/// How far a filled frame is to be trusted, by its own confidence.
struct Doubt {
  double within = 0;    ///< mean confidence over the hole: the share of its pixels expected within 10 gray levels of the truth
  double pixels = 0;    ///< expected to be farther off
  cv::Rect worst;       ///< where most of these lie together; empty: there is no hole
  double in_worst = 0;  ///< of `pixels`
};

/// `kind` and `confidence` as harmonize::FilledFrame has them.
Doubt doubt(const cv::Mat1b& kind, const cv::Mat1b& confidence);

}  // namespace dvi::report
