#include "dvi/labels/trace_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

namespace dvi::labels {
namespace {

using Loop = std::vector<cv::Point>;  // corners of pixels

// The directions along edges of pixels: right, down, left, up. The mask is on the right-hand side.
const std::array<cv::Point, 4> kSteps{cv::Point(1, 0), cv::Point(0, 1), cv::Point(-1, 0), cv::Point(0, -1)};
const std::array<cv::Point, 4> kRightPixels{cv::Point(0, 0), cv::Point(-1, 0), cv::Point(-1, -1), cv::Point(0, -1)};
const std::array<cv::Point, 4> kLeftPixels{cv::Point(0, -1), cv::Point(0, 0), cv::Point(-1, 0), cv::Point(-1, -1)};

/// The boundary of one connected part: around it, and around its holes.
struct Boundary {
  Loop outer;
  std::vector<Loop> holes;
};

class Tracer {
 public:
  explicit Tracer(const cv::Mat1b& mask) : mask_(mask), traced_(mask.size(), uchar{0}) {}

  /// Returns the boundaries of all parts, which are connected by edges of pixels, in order of their first pixel.
  std::vector<Boundary> trace() {
    cv::Mat1i parts;
    constexpr int kConnectedByEdges = 4;
    std::vector<Boundary> boundaries(
        static_cast<std::size_t>(cv::connectedComponents(mask_ != 0, parts, kConnectedByEdges, CV_32S) - 1));
    for (int y = 0; y < mask_.rows; ++y)
      for (int x = 0; x < mask_.cols; ++x) {
        if (!is_edge({x, y}, 0) || traced_(y, x) != 0) continue;
        Boundary& boundary = boundaries[static_cast<std::size_t>(parts(y, x) - 1)];
        // The first pixel of a part is on its outer boundary.
        if (boundary.outer.empty())
          boundary.outer = follow({x, y});
        else
          boundary.holes.push_back(follow({x, y}));
      }
    return boundaries;
  }

 private:
  bool is_inside(const cv::Point& pixel) const { return cv::Rect({0, 0}, mask_.size()).contains(pixel) && mask_(pixel) != 0; }
  // Returns whether the edge from a corner in a direction separates the mask from its surroundings.
  bool is_edge(const cv::Point& corner, std::size_t direction) const {
    return is_inside(corner + kRightPixels[direction]) && !is_inside(corner + kLeftPixels[direction]);
  }

  // Follows the boundary from the upper edge of a pixel.
  Loop follow(const cv::Point& start) {
    Loop loop;
    cv::Point at = start;
    std::size_t direction = 0;
    do {
      if (direction == 0) traced_(at) = 1;
      at += kSteps[direction];
      const std::array<std::size_t, 3> next{(direction + 1) % 4, direction, (direction + 3) % 4};
      const std::size_t before = direction;
      direction = *std::find_if(next.begin(), next.end(), [&](std::size_t turned) { return is_edge(at, turned); });
      if (direction != before) loop.push_back(at);
    } while (at != start || direction != 0);
    return loop;
  }

  const cv::Mat1b& mask_;
  cv::Mat1b traced_;  // upper edges of pixels
};

using Corners = std::vector<cv::Point2f>;

// Returns the middles of all edges of pixels along a boundary, which run straight where the boundary is a staircase.
Corners list_edge_middles(const Loop& loop) {
  Corners out;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const cv::Point along = loop[(i + 1) % loop.size()] - loop[i];
    const int length = std::max(std::abs(along.x), std::abs(along.y));
    for (int k = 0; k < length; ++k)
      out.push_back(cv::Point2f(loop[i]) + static_cast<float>((k + 0.5) / length) * cv::Point2f(along));
  }
  return out;
}

// Leaves out corners. Returns all corners if the tolerance is 0.
Corners simplify(const Loop& loop, double tolerance_px) {
  Corners out;
  if (tolerance_px > 0) cv::approxPolyDP(list_edge_middles(loop), out, tolerance_px, true);
  return out.size() < 3 ? Corners(loop.begin(), loop.end()) : out;
}

// Inserts a hole at the pair of corners that are nearest to each other.
void join(const Corners& hole, Corners& outer) {
  std::size_t from = 0, to = 0;
  float nearest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < outer.size(); ++i)
    for (std::size_t k = 0; k < hole.size(); ++k) {
      const cv::Point2f d = outer[i] - hole[k];
      if (const float distance = d.dot(d); distance < nearest) nearest = distance, from = i, to = k;
    }
  Corners joined(outer.begin(), outer.begin() + static_cast<std::ptrdiff_t>(from) + 1);
  for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(to + k) % hole.size()]);
  joined.insert(joined.end(), outer.begin() + static_cast<std::ptrdiff_t>(from), outer.end());
  outer = std::move(joined);
}

std::vector<Polygon> to_polygons(const std::vector<Boundary>& boundaries, double tolerance_px) {
  std::vector<Polygon> polygons;
  for (const Boundary& boundary : boundaries) {
    Corners corners = simplify(boundary.outer, tolerance_px);
    for (const Loop& hole : boundary.holes) join(simplify(hole, tolerance_px), corners);
    polygons.emplace_back(corners.begin(), corners.end());
  }
  return polygons;
}

double measure_overlap(const cv::Mat1b& mask, const std::vector<Polygon>& polygons) {
  cv::Mat1b drawn(mask.size(), uchar{0});
  draw(to_outline(polygons, mask.size()), drawn);
  return cv::countNonZero(mask & drawn) / static_cast<double>(cv::countNonZero(mask | drawn));
}

}  // namespace

std::vector<Polygon> trace_polygons(const cv::Mat1b& mask, double min_overlap) {
  std::vector<Boundary> boundaries = Tracer(mask).trace();
  if (boundaries.empty()) return {};
  std::stable_sort(boundaries.begin(), boundaries.end(),
                   [](const Boundary& a, const Boundary& b) { return cv::contourArea(a.outer) > cv::contourArea(b.outer); });
  cv::Mat1b filled;
  cv::compare(mask, 0, filled, cv::CMP_NE);
  for (const double tolerance_px : {1.0, 0.7, 0.4})
    if (std::vector<Polygon> polygons = to_polygons(boundaries, tolerance_px); measure_overlap(filled, polygons) >= min_overlap)
      return polygons;
  return to_polygons(boundaries, 0);
}

}  // namespace dvi::labels
