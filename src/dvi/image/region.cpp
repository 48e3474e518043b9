#include "dvi/image/region.h"

#include <cstdlib>

#include <opencv2/imgproc.hpp>

#include "dvi/image/enlarge.h"

namespace dvi {
namespace {

/// Computes `change(mask)` in the part of a mask that can differ from 0, given the distance over which pixels are changed.
template <class Change>
cv::Mat1b change_near_mask(const cv::Mat1b& mask, int distance_px, const Change& change) {
  cv::Mat1b out(mask.size(), uchar{0});
  const cv::Rect tight = cv::boundingRect(mask);
  if (tight.empty()) return out;
  const cv::Rect box = enlarge(tight, distance_px, mask.size());
  change(mask(box)).copyTo(out(box));
  return out;
}

}  // namespace

Region::Region(const cv::Mat1b& mask) : index(mask.size(), -1) {
  const cv::Rect box = cv::boundingRect(mask);
  for (int y = box.y; y < box.br().y; ++y)
    for (int x = box.x; x < box.br().x; ++x)
      if (mask(y, x) != 0) {
        index(y, x) = static_cast<int>(pixels.size());
        pixels.emplace_back(x, y);
      }
}

cv::Mat1b grown(const cv::Mat1b& mask, int radius) {
  if (radius == 0) return mask.clone();
  const int distance_px = std::abs(radius), side = 2 * distance_px + 1;
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side});
  return change_near_mask(mask, distance_px + 1, [&](const cv::Mat1b& near) {
    cv::Mat1b out;
    if (radius > 0)
      cv::dilate(near, out, disc);
    else
      cv::erode(near, out, disc);
    return out;
  });
}

cv::Mat1b grown_far(const cv::Mat1b& mask, int radius) {
  return change_near_mask(mask, std::abs(radius) + 2, [&](const cv::Mat1b& near) {
    cv::Mat1f distance;
    cv::distanceTransform(radius < 0 ? near : cv::Mat1b(near == 0), distance, cv::DIST_L2, cv::DIST_MASK_5);
    return radius < 0 ? cv::Mat1b(distance > -radius) : cv::Mat1b(distance <= radius);
  });
}

int label_connected_parts(const cv::Mat1b& mask, cv::Mat1i& labels) {
  return cv::connectedComponents(mask, labels, 4, CV_32S) - 1;
}

cv::Rect box_of_part(const cv::Mat1i& statistics, int part) {
  return {statistics(part, cv::CC_STAT_LEFT), statistics(part, cv::CC_STAT_TOP), statistics(part, cv::CC_STAT_WIDTH),
          statistics(part, cv::CC_STAT_HEIGHT)};
}

std::vector<cv::Rect> find_part_boxes(const cv::Mat1b& mask) {
  constexpr int kBlockPx = 2;  // parts are labeled by blocks of 2 x 2 pixels, which determine their order
  std::vector<cv::Rect> out;
  const cv::Rect tight = cv::boundingRect(mask);
  if (tight.empty()) return out;
  const cv::Point corner(tight.x - tight.x % kBlockPx, tight.y - tight.y % kBlockPx);
  cv::Mat1i labels, boxes;
  cv::Mat1d centers;
  const int count = cv::connectedComponentsWithStats(mask(cv::Rect(corner, tight.br())), labels, boxes, centers, 8, CV_32S);
  for (int i = 1; i < count; ++i) out.push_back(box_of_part(boxes, i) + corner);  // 0 is the background
  return out;
}

}  // namespace dvi
