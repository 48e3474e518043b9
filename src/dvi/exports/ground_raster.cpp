#include "dvi/exports/ground_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/error.h"

namespace dvi::exports {
namespace {

// The settings of the estimate of the ground.
struct GroundParams {
  double square_m = 1;     // the lowest point in a square and its neighbors is ground
  float curb_m = 0.3F;     // height above it that still belongs to the ground
  double max_gap_m = 0.5;  // over which gaps are closed
  double max_cells = 1 << 26;
};
constexpr GroundParams kGroundParams;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

struct Box {
  double west, south, east, north;

  cv::Size cells(double cell) const {
    return {static_cast<int>(std::ceil((east - west) / cell)) + 1, static_cast<int>(std::ceil((north - south) / cell)) + 1};
  }
  cv::Point of(const CloudPoint& p, double cell) const {
    return {static_cast<int>((double{p.position.x()} - west) / cell),
            static_cast<int>((north - double{p.position.y()}) / cell)};
  }
};

Box find_box(const std::vector<CloudPoint>& cloud) {
  Eigen::Vector3f low = cloud.front().position, high = low;
  for (const CloudPoint& p : cloud) low = low.cwiseMin(p.position), high = high.cwiseMax(p.position);
  return {double{low.x()}, double{low.y()}, double{high.x()}, double{high.y()}};
}

// Finds the lowest point of each square and its neighbors. Single low points (echoes below the ground) are rare in a static
// map.
cv::Mat1f find_lowest(const std::vector<CloudPoint>& cloud, const Box& box) {
  cv::Mat1f low(box.cells(kGroundParams.square_m), std::numeric_limits<float>::max());
  for (const CloudPoint& p : cloud) {
    float& height = low(box.of(p, kGroundParams.square_m));
    height = std::min(height, p.position.z());
  }
  cv::erode(low, low, cv::Mat1b::ones(3, 3));
  return low;
}

// Computes the mean height of the ground points in each cell.
cv::Mat1f compute_mean_height(const std::vector<CloudPoint>& cloud, const Box& box, double cell) {
  const cv::Mat1f low = find_lowest(cloud, box);
  cv::Mat1f sum(box.cells(cell), 0.0F), count(sum.size(), 0.0F);
  for (const CloudPoint& p : cloud) {
    if (p.position.z() > low(box.of(p, kGroundParams.square_m)) + kGroundParams.curb_m) continue;
    const cv::Point at = box.of(p, cell);
    sum(at) += p.position.z();
    count(at) += 1;
  }
  cv::Mat1f mean(sum.size(), kUnknown);
  for (int y = 0; y < sum.rows; ++y)
    for (int x = 0; x < sum.cols; ++x)
      if (count(y, x) > 0) mean(y, x) = sum(y, x) / count(y, x);
  return mean;
}

// Fills cells without measurements by the mean of measured ones in growing windows.
void close_gaps(cv::Mat1f& height, double cell) {
  cv::Mat1f known(height.size()), value(height.size());
  for (int radius = 1; radius <= std::max(1, static_cast<int>(kGroundParams.max_gap_m / cell)); radius *= 2) {
    for (int y = 0; y < height.rows; ++y)
      for (int x = 0; x < height.cols; ++x) {
        known(y, x) = std::isnan(height(y, x)) ? 0.0F : 1.0F;
        value(y, x) = std::isnan(height(y, x)) ? 0.0F : height(y, x);
      }
    const cv::Size window(2 * radius + 1, 2 * radius + 1);
    cv::boxFilter(known, known, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
    cv::boxFilter(value, value, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
    for (int y = 0; y < height.rows; ++y)
      for (int x = 0; x < height.cols; ++x)
        if (std::isnan(height(y, x)) && known(y, x) > 0.5F) height(y, x) = value(y, x) / known(y, x);
  }
}

}  // namespace

GroundRaster ground_of(const std::vector<CloudPoint>& cloud, double cell_m) {
  const Box box = find_box(cloud);
  const double cells = (box.east - box.west) / cell_m * (box.north - box.south) / cell_m;
  if (cells > kGroundParams.max_cells)
    throw UsageError(fmt::format(
        "--cell-m {}: an image of {:.0f} m x {:.0f} m would have {:.0f} million pixels; give at least {:.2f}", cell_m,
        box.east - box.west, box.north - box.south, cells / 1e6, cell_m * std::sqrt(cells / kGroundParams.max_cells) + 0.005));
  GroundRaster ground{cell_m, box.west, box.north, compute_mean_height(cloud, box, cell_m)};
  close_gaps(ground.height, cell_m);
  return ground;
}

}  // namespace dvi::exports
