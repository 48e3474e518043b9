#include "dvi/align/unmasked_points.h"

#include <algorithm>

#include "dvi/image/region.h"

namespace dvi::align {
namespace {

constexpr int kScalePx = 4;  // pixels of the image per pixel of the depths
constexpr double kTolerance = map::VisibleMap::kTolerance;
constexpr int kMaskMarginPx = 5;

float find_min_around(const cv::Mat1f& z, int x, int y) {
  float lowest = 1e9F;
  const cv::Rect around = cv::Rect(x - 1, y - 1, 3, 3) & cv::Rect({}, z.size());
  for (int row = around.y; row < around.br().y; ++row)
    for (int col = around.x; col < around.br().x; ++col) lowest = std::min(lowest, z(row, col));
  return lowest;
}

}  // namespace

UnmaskedPoints::UnmaskedPoints(const std::vector<map::VisiblePoint>& visible, const cv::Mat1b& mask)
    : masked_(grown(mask, kMaskMarginPx)), nearest_(mask.rows / kScalePx + 1, mask.cols / kScalePx + 1, 1e9F) {
  for (const map::VisiblePoint& p : visible) {
    const cv::Point pixel(cvRound(p.u), cvRound(p.v));
    float& z = nearest_(pixel.y / kScalePx, pixel.x / kScalePx);
    z = std::min(z, p.z);
    if (!is_masked(pixel)) points_.push_back(p);
  }
}

bool UnmaskedPoints::is_visible(const Eigen::Vector2d& pixel, double z) const {
  const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
  return !is_masked(at) && z <= find_min_around(nearest_, at.x / kScalePx, at.y / kScalePx) * (1 + 2 * kTolerance);
}

bool UnmaskedPoints::is_near_edge(const map::VisiblePoint& p) const {
  return p.z > find_min_around(nearest_, cvRound(p.u) / kScalePx, cvRound(p.v) / kScalePx) * (1 + 2 * kTolerance);
}

}  // namespace dvi::align
