#include "dvi/image/region.h"

#include <cstdlib>

#include <opencv2/imgproc.hpp>

namespace dvi {

Region::Region(const cv::Mat1b& mask) : index(mask.size(), -1) {
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask(y, x) != 0) {
        index(y, x) = static_cast<int>(pixels.size());
        pixels.emplace_back(x, y);
      }
}

cv::Mat1b grown(const cv::Mat1b& mask, int radius) {
  if (radius == 0) return mask.clone();
  const int side = 2 * std::abs(radius) + 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
  cv::Mat1b out;
  if (radius > 0)
    cv::dilate(mask, out, disc);
  else
    cv::erode(mask, out, disc);
  return out;
}

cv::Mat1b grown_far(const cv::Mat1b& mask, int radius) {
  cv::Mat1f distance;
  if (radius < 0) {
    cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_5);
    return cv::Mat1b(distance > -radius);
  }
  cv::distanceTransform(cv::Mat1b(mask == 0), distance, cv::DIST_L2, cv::DIST_MASK_5);
  return cv::Mat1b(distance <= radius);
}

int label_connected_parts(const cv::Mat1b& mask, cv::Mat1i& labels) {
  return cv::connectedComponents(mask, labels, 4, CV_32S) - 1;
}

cv::Rect box_of_part(const cv::Mat1i& statistics, int part) {
  return {statistics(part, cv::CC_STAT_LEFT), statistics(part, cv::CC_STAT_TOP), statistics(part, cv::CC_STAT_WIDTH),
          statistics(part, cv::CC_STAT_HEIGHT)};
}

std::vector<cv::Rect> find_part_boxes(const cv::Mat1b& mask) {
  cv::Mat1i labels, boxes;
  cv::Mat1d centers;
  const int count = cv::connectedComponentsWithStats(mask, labels, boxes, centers, 8, CV_32S);
  std::vector<cv::Rect> out;
  for (int i = 1; i < count; ++i) out.push_back(box_of_part(boxes, i));  // 0 is the background
  return out;
}

}  // namespace dvi
