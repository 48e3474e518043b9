#include "dvi/report/doubt.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace dvi::report {

Doubt doubt(const cv::Mat1b& kind, const cv::Mat1b& confidence) {
  constexpr int kPart = 5;  // of the image's width: a crop of it shows details at twice their size or more
  const cv::Mat1b hole(kind != 0);
  const int pixels = cv::countNonZero(hole);
  Doubt found;
  if (pixels == 0 || confidence.empty()) return found;
  cv::Mat1b doubts(kind.size(), uchar{0});
  cv::subtract(cv::Scalar(255), confidence, doubts, hole);
  found.pixels = cv::sum(doubts)[0] / 255;
  found.within = 1 - found.pixels / pixels;
  cv::Mat1d sums;
  cv::integral(doubts, sums, CV_64F);
  const int width = std::max(1, kind.cols / kPart), height = std::min(kind.rows, std::max(1, width * 9 / 16));
  double most = -1;
  for (int y = 0; y + height <= kind.rows; y += std::max(1, height / 4))
    for (int x = 0; x + width <= kind.cols; x += std::max(1, width / 4)) {
      const double sum = sums(y + height, x + width) - sums(y, x + width) - sums(y + height, x) + sums(y, x);
      if (sum <= most) continue;
      most = sum;
      found.worst = {x, y, width, height};
    }
  found.in_worst = most / 255;
  return found;
}

}  // namespace dvi::report
