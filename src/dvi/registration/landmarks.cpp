#include "dvi/registration/landmarks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include <opencv2/core.hpp>

namespace dvi::registration {
namespace {

using Eigen::Vector3d;

constexpr int kMaxShift = kLandmarks.max_shift_cells;

/// The points of a place, blurred by one cell, for looking up shifts.
class OccupancyGrid {
 public:
  explicit OccupancyGrid(const std::vector<Vector3d>& points) {
    const int sizes[] = {kLayers, kSide, kSide};
    cells_ = cv::Mat(3, sizes, CV_8U, cv::Scalar(0));
    for (const Vector3d& p : points) {
      const cv::Point3i c = cell_of(p);
      for (int z = c.z - 1; z <= c.z + 1; ++z)
        for (int y = c.y - 1; y <= c.y + 1; ++y)
          for (int x = c.x - 1; x <= c.x + 1; ++x) {
            if (!inside(x, y, z)) continue;
            const uchar weight = x == c.x && y == c.y ? 2 : 1;
            uchar& cell = cells_.at<uchar>(z, y, x);
            cell = std::max(cell, weight);
          }
    }
  }
  static cv::Point3i cell_of(const Vector3d& p) {
    return {cvFloor((p.x() + kLandmarks.grid_radius_m) / kLandmarks.cell_m),
            cvFloor((p.y() + kLandmarks.grid_radius_m) / kLandmarks.cell_m),
            cvFloor((p.z() - kLandmarks.min_height_m) / kLandmarks.layer_m)};
  }
  int at(int x, int y, int z) const { return inside(x, y, z) ? cells_.at<uchar>(z, y, x) : 0; }

 private:
  static constexpr int kSide = static_cast<int>(2 * kLandmarks.grid_radius_m / kLandmarks.cell_m),
                       kLayers = static_cast<int>((kLandmarks.max_height_m - kLandmarks.min_height_m) / kLandmarks.layer_m);
  static bool inside(int x, int y, int z) { return x >= 0 && y >= 0 && z >= 0 && x < kSide && y < kSide && z < kLayers; }
  cv::Mat cells_;
};

/// The similarity, 0 to 1, of a block at each shift.
cv::Mat1f compute_similarity(const OccupancyGrid& grid, const std::vector<Vector3d>& block) {
  const std::size_t step = 1 + block.size() / kLandmarks.max_points;
  cv::Mat1f out(2 * kMaxShift + 1, 2 * kMaxShift + 1, 0.0F);
  float n = 0;
  for (std::size_t i = 0; i < block.size(); i += step, ++n) {
    const cv::Point3i c = OccupancyGrid::cell_of(block[i]);
    for (int y = -kMaxShift; y <= kMaxShift; ++y)
      for (int x = -kMaxShift; x <= kMaxShift; ++x)
        out(y + kMaxShift, x + kMaxShift) += static_cast<float>(grid.at(c.x + x, c.y + y, c.z));
  }
  return cv::Mat1f(out / (2 * n));
}

/// The mean similarity at other places, in the direction in which it decreases least.
double compute_self_similarity(const cv::Mat1f& similarity, cv::Point best) {
  constexpr int kDirections = 16;
  double highest = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = std::numbers::pi * k / kDirections;
    double sum = 0, n = 0;
    for (const int sign : {-1, 1})
      for (int distance = kLandmarks.other_place_cells; distance <= kMaxShift; ++distance) {
        const cv::Point at =
            best + cv::Point(cvRound(sign * distance * std::cos(angle)), cvRound(sign * distance * std::sin(angle)));
        if (!cv::Rect(0, 0, similarity.cols, similarity.rows).contains(at)) continue;
        sum += similarity(at), ++n;
      }
    if (n > 0) highest = std::max(highest, sum / n);
  }
  return highest;
}

/// Returns whether a point belongs to a structure that continues on both sides, such as a wall.
bool is_on_wall(const OccupancyGrid& grid, const Vector3d& point) {
  constexpr int kWallDirections = 8;
  constexpr std::array kDistancesCells{4, 7, 10};
  constexpr int kMinOccupied = 5;  // out of six cells
  const cv::Point3i c = OccupancyGrid::cell_of(point);
  for (int k = 0; k < kWallDirections; ++k) {
    const double x = std::cos(std::numbers::pi * k / kWallDirections), y = std::sin(std::numbers::pi * k / kWallDirections);
    int occupied = 0;
    for (const int distance : kDistancesCells)
      for (const int sign : {-1, 1})
        occupied += grid.at(c.x + cvRound(sign * distance * x), c.y + cvRound(sign * distance * y), c.z) > 0 ? 1 : 0;
    if (occupied >= kMinOccupied) return true;
  }
  return false;
}

}  // namespace

LandmarkVotes check_landmarks(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  const OccupancyGrid grid(a), own(b);
  std::map<std::pair<int, int>, std::vector<Vector3d>> blocks;
  for (const Vector3d& p : b)
    if (p.z() > kLandmarks.min_point_height_m && !is_on_wall(own, p))
      blocks[{cvFloor(p.x() / kLandmarks.block_m), cvFloor(p.y() / kLandmarks.block_m)}].push_back(p);
  LandmarkVotes out;
  for (const auto& [place, block] : blocks) {
    if (block.size() < kLandmarks.min_points) continue;
    const cv::Mat1f similarity = compute_similarity(grid, block);
    double highest = 0;
    cv::Point best;
    cv::minMaxLoc(similarity, nullptr, &highest, nullptr, &best);
    if (highest < kLandmarks.min_similarity ||
        compute_self_similarity(similarity, best) > kLandmarks.max_self_similarity * highest)
      continue;
    const cv::Point shift = best - cv::Point(kMaxShift, kMaxShift);
    ++(std::max(std::abs(shift.x), std::abs(shift.y)) <= kLandmarks.tolerance_cells ? out.inliers : out.outliers);
  }
  return out;
}

}  // namespace dvi::registration
