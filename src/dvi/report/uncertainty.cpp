#include "dvi/report/uncertainty.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace dvi::report {

Uncertainty estimate_uncertainty(const cv::Mat1b& kind, const cv::Mat1b& confidence) {
  constexpr int kPartsPerWidth = 5;  // a crop of this size shows details at twice their size or more
  const cv::Mat1b hole(kind != 0);
  const int pixels = cv::countNonZero(hole);
  Uncertainty found;
  if (pixels == 0 || confidence.empty()) return found;
  cv::Mat1b errors(kind.size(), uchar{0});
  cv::subtract(cv::Scalar(255), confidence, errors, hole);
  found.pixels = cv::sum(errors)[0] / 255;
  found.within = 1 - found.pixels / pixels;
  cv::Mat1d sums;
  cv::integral(errors, sums, CV_64F);
  const int width = std::max(1, kind.cols / kPartsPerWidth), height = std::min(kind.rows, std::max(1, width * 9 / 16));
  double highest = -1;
  for (int y = 0; y + height <= kind.rows; y += std::max(1, height / 4))
    for (int x = 0; x + width <= kind.cols; x += std::max(1, width / 4)) {
      const double sum = sums(y + height, x + width) - sums(y, x + width) - sums(y + height, x) + sums(y, x);
      if (sum <= highest) continue;
      highest = sum;
      found.worst = {x, y, width, height};
    }
  found.in_worst = highest / 255;
  return found;
}

}  // namespace dvi::report
