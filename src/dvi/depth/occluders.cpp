#include "dvi/depth/occluders.h"

#include <algorithm>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "dvi/core/median.h"
#include "dvi/image/region.h"

namespace dvi::depth {
namespace {

/// Parameters of the search for occluders.
struct OccluderParams {
  float max_depth_m = 60;        ///< Farther returns are too sparse to form groups.
  float min_step_share = 0.07F;  ///< Step in depth to the map, relative to the depth: errors of poses, slanted surfaces ...
  float min_step_m = 0.3F;       ///< ... and in meters.
  int edge_px = 2;               ///< Errors of the calibration, by which edges of the map are displaced.
  int max_gap_px = 25;           ///< Largest gap between rays that is closed.
  int bucket_px = 8;             ///< Width of the columns in which gaps between rays are measured.
  int min_returns = 4;           ///< Smaller groups are noise.
  int margin_px = 3;             ///< Parts of things between their outermost returns and their edges.
};
constexpr OccluderParams kOccluders;

/// Estimates the vertical gap between rays in pixels.
int estimate_gap_px(const std::vector<ImageReturn>& returns, int width) {
  std::vector<std::vector<float>> columns(static_cast<std::size_t>(width / kOccluders.bucket_px) + 1);
  for (const ImageReturn& r : returns) columns[static_cast<std::size_t>(r[0]) / kOccluders.bucket_px].push_back(r[1]);
  std::vector<float> gaps;
  for (std::vector<float>& rows : columns) {
    std::sort(rows.begin(), rows.end());
    for (std::size_t i = 1; i < rows.size(); ++i)
      if (rows[i] - rows[i - 1] >= 1) gaps.push_back(rows[i] - rows[i - 1]);  // less: the same ray
  }
  if (gaps.empty()) return kOccluders.max_gap_px;
  return std::clamp(cvCeil(median(std::move(gaps))), 1, kOccluders.max_gap_px);
}

/// Removes the connected parts of a mask with few returns.
void remove_small_groups(const cv::Mat1b& returns, cv::Mat1b& mask) {
  cv::Mat1i labels;
  const int count = cv::connectedComponents(mask, labels, 8, CV_32S);
  std::vector<int> members(static_cast<std::size_t>(count), 0);
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (returns(y, x) != 0) ++members[static_cast<std::size_t>(labels(y, x))];
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x)
      if (mask(y, x) != 0 && members[static_cast<std::size_t>(labels(y, x))] < kOccluders.min_returns) mask(y, x) = 0;
}

}  // namespace

cv::Mat1b find_occluders(const DepthMap& depth, const std::vector<ImageReturn>& returns) {
  const cv::Size size = depth.z.size();
  cv::Mat1b front(size, uchar{0});
  if (returns.empty()) return front;
  const int edge = 2 * kOccluders.edge_px + 1;
  cv::Mat1f nearest;
  cv::erode(depth.z, nearest, cv::getStructuringElement(cv::MORPH_ELLIPSE, {edge, edge}));
  for (const ImageReturn& r : returns) {
    const int x = cvRound(r[0]), y = cvRound(r[1]);
    const float limit = nearest(y, x);
    if (r[2] > kOccluders.max_depth_m || limit == DepthMap::kUnknown) continue;
    if (r[2] + kOccluders.min_step_m >= limit * (1 - kOccluders.min_step_share)) continue;
    front(y, x) = 255;
  }
  if (cv::countNonZero(front) == 0) return front;
  const int gap = estimate_gap_px(returns, size.width);
  cv::Mat1b closed;
  cv::morphologyEx(front, closed, cv::MORPH_CLOSE, cv::Mat1b::ones(3 * gap + 1, 2 * gap + 1));
  remove_small_groups(front, closed);
  return grown(closed, kOccluders.margin_px);
}

}  // namespace dvi::depth
