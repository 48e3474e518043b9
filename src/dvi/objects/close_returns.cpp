#include "dvi/objects/close_returns.h"

#include <algorithm>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/image/enlarge.h"
#include "dvi/image/region.h"

namespace dvi::objects {
namespace {

struct CloseParams {
  double max_gap_deg = 0.35;      ///< between the columns of a scan
  double max_row_gap_deg = 0.85;  ///< between its rows; scanners with fewer rows do not show the shape of things
  double min_height_deg = 1;      ///< of a surface: more than two rows
  int min_returns = 6;            ///< of a surface
};
constexpr CloseParams kClose;

int to_pixels(double deg, double focal_px) { return cvCeil(deg * std::numbers::pi / 180 * focal_px); }

}  // namespace

cv::Mat1b close_returns(const cv::Mat1b& returns, const Camera& camera) {
  cv::Mat1b out(returns.size(), uchar{0});
  const int columns_px = to_pixels(kClose.max_gap_deg, camera.fx), rows_px = to_pixels(kClose.max_row_gap_deg, camera.fy);
  const cv::Rect area = enlarge(cv::boundingRect(returns), std::max(columns_px, rows_px), returns.size());
  if (area.empty()) return out;
  cv::Mat1b closed;
  cv::morphologyEx(returns(area), closed, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_RECT, {1 + columns_px, 1 + rows_px}));
  cv::Mat1i parts, stats;
  cv::Mat centers;
  const int count = cv::connectedComponentsWithStats(closed, parts, stats, centers, 8, CV_32S);
  for (int i = 1; i < count; ++i) {
    const cv::Mat1b part(parts == i);
    if (stats(i, cv::CC_STAT_HEIGHT) < to_pixels(kClose.min_height_deg, camera.fy) ||
        cv::countNonZero(part & returns(area)) < kClose.min_returns)
      continue;
    out(area).setTo(255, part);
  }
  return out;
}

}  // namespace dvi::objects
