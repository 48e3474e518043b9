#include "dvi/registration/confirm.h"

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

constexpr double kCell = 0.15, kLayer = 0.4;             // meters
constexpr double kGridRadius = 50;                       // meters: of the grid
constexpr double kGridLowest = -1.5, kGridHighest = 10;  // meters
constexpr int kShifts = 10;                              // cells each way
constexpr int kTolerance = 1;                            // cells
constexpr int kElsewhere = 4;                            // cells: from here on a shift is another place
constexpr double kBlock = 6;                             // meters
constexpr double kFloor = 0.25;                          // meters above the ground: below, curbs and the road
constexpr std::size_t kFewest = 15, kMost = 400;         // points of a block
constexpr double kLikeness = 0.4;  // of a block's points that the other place must have, wherever it is shifted
constexpr double kDistinct = 0.6;  // a block that fits more than this elsewhere in some direction says nothing

/// Where the points of a place are, for looking up shifts.
class Grid {
 public:
  explicit Grid(const std::vector<Vector3d>& points) {
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
    return {cvFloor((p.x() + kGridRadius) / kCell), cvFloor((p.y() + kGridRadius) / kCell),
            cvFloor((p.z() - kGridLowest) / kLayer)};
  }
  int at(int x, int y, int z) const { return inside(x, y, z) ? cells_.at<uchar>(z, y, x) : 0; }

 private:
  static constexpr int kSide = static_cast<int>(2 * kGridRadius / kCell),
                       kLayers = static_cast<int>((kGridHighest - kGridLowest) / kLayer);
  static bool inside(int x, int y, int z) { return x >= 0 && y >= 0 && z >= 0 && x < kSide && y < kSide && z < kLayers; }
  cv::Mat cells_;
};

/// Likeness, 0 to 1, of a block at each shift.
cv::Mat1f likeness(const Grid& grid, const std::vector<Vector3d>& block) {
  const std::size_t step = 1 + block.size() / kMost;
  cv::Mat1f out(2 * kShifts + 1, 2 * kShifts + 1, 0.0F);
  float n = 0;
  for (std::size_t i = 0; i < block.size(); i += step, ++n) {
    const cv::Point3i c = Grid::cell_of(block[i]);
    for (int y = -kShifts; y <= kShifts; ++y)
      for (int x = -kShifts; x <= kShifts; ++x)
        out(y + kShifts, x + kShifts) += static_cast<float>(grid.at(c.x + x, c.y + y, c.z));
  }
  return cv::Mat1f(out / (2 * n));
}

/// The mean likeness a place away, in the direction in which it falls least.
double elsewhere(const cv::Mat1f& likeness, cv::Point best) {
  constexpr int kDirections = 16;
  double most = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = std::numbers::pi * k / kDirections;
    double sum = 0, n = 0;
    for (const int sign : {-1, 1})
      for (int far = kElsewhere; far <= kShifts; ++far) {
        const cv::Point at = best + cv::Point(cvRound(sign * far * std::cos(angle)), cvRound(sign * far * std::sin(angle)));
        if (!cv::Rect(0, 0, likeness.cols, likeness.rows).contains(at)) continue;
        sum += likeness(at), ++n;
      }
    if (n > 0) most = std::max(most, sum / n);
  }
  return most;
}

/// Whether a point is of something that goes on to both sides, as walls do.
bool goes_on(const Grid& grid, const Vector3d& point) {
  constexpr int kDirections = 8;
  constexpr std::array kFar{4, 7, 10};
  const cv::Point3i c = Grid::cell_of(point);
  for (int k = 0; k < kDirections; ++k) {
    const double x = std::cos(std::numbers::pi * k / kDirections), y = std::sin(std::numbers::pi * k / kDirections);
    int on = 0;
    for (const int far : kFar)
      for (const int sign : {-1, 1})
        on += grid.at(c.x + cvRound(sign * far * x), c.y + cvRound(sign * far * y), c.z) > 0 ? 1 : 0;
    if (on >= 5) return true;
  }
  return false;
}

}  // namespace

Confirmation confirm(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  const Grid grid(a), own(b);
  std::map<std::pair<int, int>, std::vector<Vector3d>> blocks;
  for (const Vector3d& p : b)
    if (p.z() > kFloor && !goes_on(own, p)) blocks[{cvFloor(p.x() / kBlock), cvFloor(p.y() / kBlock)}].push_back(p);
  Confirmation out;
  for (const auto& [place, block] : blocks) {
    if (block.size() < kFewest) continue;
    const cv::Mat1f like = likeness(grid, block);
    double most = 0;
    cv::Point best;
    cv::minMaxLoc(like, nullptr, &most, nullptr, &best);
    if (most < kLikeness || elsewhere(like, best) > kDistinct * most) continue;
    const cv::Point shift = best - cv::Point(kShifts, kShifts);
    ++(std::max(std::abs(shift.x), std::abs(shift.y)) <= kTolerance ? out.confirmed : out.moved);
  }
  return out;
}

}  // namespace dvi::registration
