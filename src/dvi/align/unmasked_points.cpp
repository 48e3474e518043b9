#include "dvi/align/sight.h"

#include <algorithm>

#include "dvi/image/region.h"

namespace dvi::align {
namespace {

constexpr int kScale = 4;  // px of the image a px of the depths
constexpr double kTolerance = map::VisibleMap::kTolerance;
constexpr int kMaskMargin = 5;  // px

float least_round(const cv::Mat1f& z, int x, int y) {
  float least = 1e9F;
  const cv::Rect around = cv::Rect(x - 1, y - 1, 3, 3) & cv::Rect({}, z.size());
  for (int row = around.y; row < around.br().y; ++row)
    for (int col = around.x; col < around.br().x; ++col) least = std::min(least, z(row, col));
  return least;
}

}  // namespace

UnmaskedPoints::UnmaskedPoints(const std::vector<map::VisiblePoint>& visible, const cv::Mat1b& mask)
    : masked_(grown(mask, kMaskMargin)), nearest_(mask.rows / kScale + 1, mask.cols / kScale + 1, 1e9F) {
  for (const map::VisiblePoint& p : visible) {
    const cv::Point pixel(cvRound(p.u), cvRound(p.v));
    float& z = nearest_(pixel.y / kScale, pixel.x / kScale);
    z = std::min(z, p.z);
    if (!masked(pixel)) points_.push_back(p);
  }
}

bool UnmaskedPoints::shows(const Eigen::Vector2d& pixel, double z) const {
  const cv::Point at(cvRound(pixel.x()), cvRound(pixel.y()));
  return !masked(at) && z <= least_round(nearest_, at.x / kScale, at.y / kScale) * (1 + 2 * kTolerance);
}

bool UnmaskedPoints::beside_nearer(const map::VisiblePoint& p) const {
  return p.z > least_round(nearest_, cvRound(p.u) / kScale, cvRound(p.v) / kScale) * (1 + 2 * kTolerance);
}

}  // namespace dvi::align
