#include "dvi/objects/close_returns.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/image/enlarge.h"

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
  std::vector<int> returns_of(static_cast<std::size_t>(count), 0);  // by part
  for (int y = 0; y < area.height; ++y)
    for (int x = 0; x < area.width; ++x)
      if (returns(area.y + y, area.x + x) != 0) ++returns_of[static_cast<std::size_t>(parts(y, x))];
  const auto is_surface = [&, min_height_px = to_pixels(kClose.min_height_deg, camera.fy)](int part) {
    return part != 0 && stats(part, cv::CC_STAT_HEIGHT) >= min_height_px &&
           returns_of[static_cast<std::size_t>(part)] >= kClose.min_returns;
  };
  for (int y = 0; y < area.height; ++y)
    for (int x = 0; x < area.width; ++x)
      if (is_surface(parts(y, x))) out(area.y + y, area.x + x) = 255;
  return out;
}

}  // namespace dvi::objects
